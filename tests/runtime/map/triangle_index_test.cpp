#include "runtime/map/triangle_index.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace roomcal::map {
namespace {

/// Markers along x at 0, 1, 3, 6, 10 ... m, a little off the line, and the triples of each three neighbours.
struct Line {
  explicit Line(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      MapMarker marker;
      marker.id = static_cast<uint32_t>(100 + i);
      marker.p_room = Vec3(static_cast<double>(i * (i + 1)) / 2, i % 2 == 0 ? 0 : 0.1, 0);
      marker.has_radius = true;
      marker.radius_m = 0.085;
      markers.push_back(marker);
    }
    for (uint16_t i = 0; i + 2U < count; ++i)
      triples.push_back({i, static_cast<uint16_t>(i + 1), static_cast<uint16_t>(i + 2)});
  }

  Result<TriangleIndex> build() {
    bytes.resize(TriangleIndex::bytes(markers.size(), triples.size()));
    Arena permanent(bytes);
    return TriangleIndex::build(markers, triples, permanent);
  }

  std::vector<MapMarker> markers;
  std::vector<MarkerTriple> triples;
  std::vector<std::byte> bytes;
};

TEST(TriangleIndex, EdgesAreOppositeToTheirMarkers) {
  Line line(6);
  const TriangleIndex index = line.build().value();
  ASSERT_EQ(index.triples().size(), 4u);
  for (const IndexedTriple& triple : index.triples()) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& a = line.markers[triple.marker[(i + 1) % 3]].p_room;
      const Vec3& b = line.markers[triple.marker[(i + 2) % 3]].p_room;
      EXPECT_NEAR(triple.edge_m[i], (a - b).norm(), 1e-5);
    }
    EXPECT_EQ(longest_edge_m(triple), *std::max_element(triple.edge_m.begin(), triple.edge_m.end()));
  }
}

TEST(TriangleIndex, LongestEdge_FindsWhatASearchThroughAllFinds) {
  Line line(12);
  const TriangleIndex index = line.build().value();
  for (const auto& [low_m, high_m] : {std::pair{0.0, 100.0}, {3.0, 7.0}, {6.9, 7.1}, {50.0, 60.0}, {5.0, 4.0}}) {
    std::vector<uint16_t> expected;
    for (std::size_t i = 0; i < index.triples().size(); ++i) {
      const double longest_m = longest_edge_m(index.triples()[i]);
      if (longest_m >= low_m && longest_m <= high_m) expected.push_back(static_cast<uint16_t>(i));
    }
    const auto found = index.with_longest_edge(low_m, high_m);
    std::vector<uint16_t> sorted(found.begin(), found.end());
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, expected) << low_m << " to " << high_m;
  }
}

TEST(TriangleIndex, Neighbours_AreTheNearestByDistance) {
  Line line(12);
  const TriangleIndex index = line.build().value();
  const IndexedMarker& last = index.markers()[11];
  ASSERT_EQ(last.neighbours, IndexedMarker::kNeighbours);
  for (std::size_t k = 0; k < IndexedMarker::kNeighbours; ++k) EXPECT_EQ(last.neighbour[k], 10 - k);
}

TEST(TriangleIndex, FewMarkers_HaveFewNeighbours) {
  Line line(3);
  const TriangleIndex index = line.build().value();
  EXPECT_EQ(index.markers()[0].neighbours, 2);
  EXPECT_EQ(index.high_room(), Vec3(3, 0.1, 0));
  EXPECT_EQ(index.low_room(), Vec3::Zero());
}

TEST(TriangleIndex, RadiiThatDiffer_AreNoCommonRadius) {
  Line line(5);
  EXPECT_NEAR(line.build().value().common_radius_m(), 0.085, 1e-12);
  line.markers[2].radius_m = 0.100;
  EXPECT_EQ(line.build().value().common_radius_m(), 0);
  line.markers[2].radius_m = 0.085;
  line.markers[4].has_radius = false;
  EXPECT_EQ(line.build().value().common_radius_m(), 0);
}

TEST(TriangleIndex, NumberOfNoMarker_IsRefused) {
  Line line(5);
  line.triples[1][2] = 5;
  EXPECT_EQ(line.build().status().code(), StatusCode::kInvalidArgument);
}

TEST(TriangleIndex, ArenaTooSmall_IsRefused) {
  Line line(5);
  for (std::size_t part = 0; part < 4; ++part) {
    std::vector<std::byte> bytes(TriangleIndex::bytes(5, 3) * part / 5);
    Arena permanent(bytes);
    EXPECT_EQ(TriangleIndex::build(line.markers, line.triples, permanent).status().code(), StatusCode::kOutOfMemory);
  }
}

}  // namespace
}  // namespace roomcal::map
