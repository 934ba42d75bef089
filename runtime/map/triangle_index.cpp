#include "runtime/map/triangle_index.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

namespace roomcal::map {
namespace {

IndexedMarker indexed(const MapMarker& marker) {
  IndexedMarker out;
  out.p_room = marker.p_room;
  out.cov_m2 = marker.cov_m2;
  Eigen::SelfAdjointEigenSolver<Mat33> eigen;
  eigen.computeDirect(marker.cov_m2, Eigen::EigenvaluesOnly);
  out.sigma_m = std::sqrt(std::max(eigen.eigenvalues()[2], 0.0));
  out.has_normal = marker.normal_room.squaredNorm() > 0.25;  // given or estimated: both tell the side
  if (out.has_normal) out.normal_room = marker.normal_room.normalized();
  out.has_radius = marker.has_radius;
  out.radius_m = marker.has_radius ? marker.radius_m : 0.0;
  return out;
}

}  // namespace

float longest_edge_m(const IndexedTriple& triple) {
  return std::max({triple.edge_m[0], triple.edge_m[1], triple.edge_m[2]});
}

std::size_t TriangleIndex::bytes(std::size_t markers, std::size_t triples) {
  return markers * sizeof(IndexedMarker) + triples * (sizeof(IndexedTriple) + sizeof(uint16_t)) +
         3 * alignof(std::max_align_t);
}

Result<TriangleIndex> TriangleIndex::build(const RoomMap& map, Arena& permanent) {
  TriangleIndex index;
  ROOMCAL_TRY(index.allocate(map.marker_count(), map.triangles().size(), permanent));
  for (std::size_t i = 0; i < index.markers_.size(); ++i) index.markers_[i] = indexed(map.marker(i));
  ROOMCAL_TRY(index.finish(map.triangles()));
  return index;
}

Result<TriangleIndex> TriangleIndex::build(std::span<const MapMarker> markers, std::span<const MarkerTriple> triples,
                                           Arena& permanent) {
  TriangleIndex index;
  ROOMCAL_TRY(index.allocate(markers.size(), triples.size(), permanent));
  for (std::size_t i = 0; i < index.markers_.size(); ++i) index.markers_[i] = indexed(markers[i]);
  ROOMCAL_TRY(index.finish(triples));
  return index;
}

Status TriangleIndex::allocate(std::size_t markers, std::size_t triples, Arena& permanent) {
  constexpr std::size_t kMost = std::numeric_limits<uint16_t>::max();
  if (markers > kMost || triples > kMost) return {StatusCode::kInvalidArgument, "more than 65535 markers or triangles"};
  markers_ = permanent.allocate<IndexedMarker>(markers);
  triples_ = permanent.allocate<IndexedTriple>(triples);
  by_longest_ = permanent.allocate<uint16_t>(triples);
  const bool complete = markers_.size() == markers && triples_.size() == triples && by_longest_.size() == triples;
  return complete ? ok_status() : out_of_arena("triangle index");
}

Status TriangleIndex::finish(std::span<const MarkerTriple> triples) {
  for (std::size_t i = 0; i < triples.size(); ++i) {
    const MarkerTriple& t = triples[i];
    for (const uint16_t marker : t) {
      if (marker >= markers_.size())
        return {StatusCode::kInvalidArgument, "a triangle names a marker that is not there"};
    }
    triples_[i].marker = t;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 edge = markers_[t[(k + 1) % 3]].p_room - markers_[t[(k + 2) % 3]].p_room;
      triples_[i].edge_m[k] = static_cast<float>(edge.norm());
    }
    by_longest_[i] = static_cast<uint16_t>(i);
  }
  std::sort(by_longest_.begin(), by_longest_.end(), [this](uint16_t a, uint16_t b) {
    const float length_a = longest_edge_m(triples_[a]);
    const float length_b = longest_edge_m(triples_[b]);
    return length_a != length_b ? length_a < length_b : a < b;
  });
  find_neighbours();
  find_bounds();
  return ok_status();
}

void TriangleIndex::find_neighbours() {
  constexpr std::size_t kMost = IndexedMarker::kNeighbours;
  for (std::size_t i = 0; i < markers_.size(); ++i) {
    IndexedMarker& marker = markers_[i];
    std::array<double, kMost> distance2{};
    for (std::size_t j = 0; j < markers_.size(); ++j) {
      if (j == i) continue;
      const double d2 = (markers_[j].p_room - marker.p_room).squaredNorm();
      std::size_t place = marker.neighbours;
      if (place == kMost && d2 >= distance2[kMost - 1]) continue;
      if (place == kMost) --place;
      for (; place > 0 && distance2[place - 1] > d2; --place) {
        distance2[place] = distance2[place - 1];
        marker.neighbour[place] = marker.neighbour[place - 1];
      }
      distance2[place] = d2;
      marker.neighbour[place] = static_cast<uint16_t>(j);
      if (marker.neighbours < kMost) ++marker.neighbours;
    }
  }
}

void TriangleIndex::find_bounds() {
  if (markers_.empty()) return;
  low_room_ = high_room_ = markers_[0].p_room;
  common_radius_m_ = markers_[0].radius_m;
  for (const IndexedMarker& marker : markers_) {
    low_room_ = low_room_.cwiseMin(marker.p_room);
    high_room_ = high_room_.cwiseMax(marker.p_room);
    const bool same = marker.has_radius && std::abs(marker.radius_m - markers_[0].radius_m) <= 0.01 * marker.radius_m;
    if (!same) common_radius_m_ = 0;
  }
}

std::span<const uint16_t> TriangleIndex::with_longest_edge(double low_m, double high_m) const {
  const auto below = [this](uint16_t triple, double length) { return longest_edge_m(triples_[triple]) < length; };
  const auto above = [this](double length, uint16_t triple) { return length < longest_edge_m(triples_[triple]); };
  const auto first = std::lower_bound(by_longest_.begin(), by_longest_.end(), low_m, below);
  const auto last = std::upper_bound(first, by_longest_.end(), high_m, above);
  return {first, last};
}

}  // namespace roomcal::map
