#include "runtime/map/room_map.h"

#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tests/runtime/map/small_map.h"

namespace roomcal::map {
namespace {

using tools::AlignedBytes;
using tools::MapData;

Result<RoomMap> open(const AlignedBytes& bytes) { return RoomMap::open(bytes.span()); }

TEST(RoomMap, Default_IsEmpty) {
  const RoomMap map;
  EXPECT_EQ(map.marker_count(), 0U);
  EXPECT_EQ(map.plane_count(), 0U);
  EXPECT_EQ(map.line_count(), 0U);
  EXPECT_EQ(map.corner_count(), 0U);
  EXPECT_EQ(map.surface_spacing_m(), 0);
  EXPECT_TRUE(map.triangles().empty());
  EXPECT_TRUE(map.ring_ratios().empty());
  EXPECT_EQ(map.map_id(), "");
  EXPECT_EQ(map.provenance(), "");
}

TEST(RoomMap, BuiltMap_ReadsBackWhole) {
  const MapData data = test::small_map();
  const AlignedBytes bytes = tools::build_map(data);
  const Result<RoomMap> opened = open(bytes);
  ASSERT_TRUE(opened.ok()) << opened.status().detail();
  const RoomMap& map = opened.value();
  EXPECT_EQ(map.map_id(), "lab");
  EXPECT_EQ(map.provenance(), "made by a test");
  EXPECT_EQ(map.created_unix_s(), 1700000000);
  ASSERT_EQ(map.marker_count(), data.markers.size());
  for (std::size_t i = 0; i < data.markers.size(); ++i) {
    const MapMarker a = map.marker(i), b = data.markers[i];
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.p_room, b.p_room) << "positions are stored as doubles";
    EXPECT_LT((a.cov_m2 - b.cov_m2).norm(), 1e-12);
    EXPECT_EQ(a.normal_room, b.normal_room);
    EXPECT_NEAR(a.radius_m, b.radius_m, 1e-8);
    EXPECT_EQ(a.has_normal, b.has_normal);
    EXPECT_EQ(a.has_radius, b.has_radius);
    EXPECT_EQ(a.normal_estimated, b.normal_estimated);
    EXPECT_EQ(a.plane, b.plane);
  }
  ASSERT_EQ(map.plane_count(), 3U);
  EXPECT_EQ(map.plane(1).normal_room, Vec3(0.6, 0.8, 0));
  EXPECT_EQ(map.plane(1).d_m, -1.5);
  EXPECT_LT((map.plane(0).cov - data.planes[0].plane.cov).norm(), 1e-13);
  EXPECT_TRUE(map.plane(1).cov.isZero(0)) << "not written, as in maps from before";
  EXPECT_EQ(map.outline_size(0), 3U);
  EXPECT_EQ(map.outline_vertex_room(0, 2), Vec3(0, 2, 0));
  EXPECT_EQ(map.outline_size(1), 0U);
  ASSERT_EQ(map.triangles().size(), 2U);
  EXPECT_EQ(map.triangles()[1], (std::array<uint16_t, 3>{1, 3, 2}));
  ASSERT_EQ(map.line_count(), 2U);
  EXPECT_EQ(map.line(1).plane_a, 1U);
  EXPECT_EQ(map.line(1).plane_b, 2U);
  EXPECT_LT((map.line(1).to_room - Vec3(0.9, 1.2, 2.5)).norm(), 1e-6);
  ASSERT_EQ(map.corner_count(), 1U);
  EXPECT_EQ(map.corner(0).planes, (std::array<std::size_t, 3>{0, 1, 2}));
  EXPECT_LT((map.corner(0).p_room - Vec3(0.9, 1.2, 0)).norm(), 1e-6);
  EXPECT_EQ(map.surface_spacing_m(), 0.0625);
  ASSERT_EQ(map.ring_ratios().size(), 6U);
  EXPECT_EQ(map.ring_ratios()[5], 0.25F);
}

TEST(RoomMap, CreationTime_IsNotContent) {
  MapData data = test::small_map();
  const AlignedBytes first = tools::build_map(data);
  data.created_unix_s += 1;
  const AlignedBytes later = tools::build_map(data);
  data.markers[0].p_room.x() += 1e-9;
  const AlignedBytes other = tools::build_map(data);
  EXPECT_EQ(open(first).value().content_crc32c(), open(later).value().content_crc32c());
  EXPECT_NE(open(first).value().content_crc32c(), open(other).value().content_crc32c());
}

TEST(RoomMap, AnyBitFlipped_IsRefused) {
  AlignedBytes bytes = tools::build_map(test::small_map());
  for (std::size_t i = 0; i < bytes.span().size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      bytes.span()[i] ^= std::byte{1} << bit;
      EXPECT_FALSE(open(bytes).ok()) << "byte " << i << " bit " << bit;
      bytes.span()[i] ^= std::byte{1} << bit;
    }
  }
  EXPECT_TRUE(open(bytes).ok());
}

TEST(RoomMap, AnyTruncation_IsRefusedAsCorrupt) {
  const AlignedBytes bytes = tools::build_map(test::small_map());
  for (std::size_t size = 0; size < bytes.span().size(); ++size) {
    EXPECT_EQ(RoomMap::open(bytes.span().first(size)).status().code(), StatusCode::kCorrupt) << size;
  }
}

TEST(RoomMap, BytesBehindTheContent_AreRefused) {
  const AlignedBytes bytes = tools::build_map(test::small_map());
  EXPECT_EQ(open(test::resized(bytes, bytes.span().size() + 1)).status().code(), StatusCode::kCorrupt);
}

TEST(RoomMap, AnotherVersion_IsUnsupported) {
  AlignedBytes bytes = tools::build_map(test::small_map());
  bytes.span()[offsetof(FileHeader, version)] = std::byte{kFormatVersion + 1};
  test::reseal(bytes);
  EXPECT_EQ(open(bytes).status().code(), StatusCode::kUnsupported);
}

TEST(RoomMap, AnotherKindOfFile_IsUnsupported) {
  AlignedBytes bytes(4096);
  EXPECT_EQ(open(bytes).status().code(), StatusCode::kUnsupported);
}

TEST(RoomMap, AnotherIdentifier_IsRefused) {
  AlignedBytes bytes = tools::build_map(test::small_map());
  bytes.span()[sizeof(FileHeader) + 4] = std::byte{'X'};
  test::reseal(bytes);
  EXPECT_EQ(open(bytes).status().code(), StatusCode::kCorrupt);
}

TEST(RoomMap, UnalignedBytes_AreInvalid) {
  AlignedBytes bytes(64);
  EXPECT_EQ(RoomMap::open(bytes.span().subspan(4)).status().code(), StatusCode::kInvalidArgument);
}

// Behind valid sums: a writer with a bug, or a forger. Whatever opens must be safe to walk.
TEST(RoomMap, AnyByteChangedUnderValidSums_IsRefusedOrSafeToRead) {
  const AlignedBytes whole = tools::build_map(test::small_map());
  std::size_t opened_count = 0;
  for (std::size_t i = sizeof(FileHeader); i < whole.span().size(); ++i) {
    for (const unsigned flip : {0x01U, 0x80U, 0xFFU}) {
      AlignedBytes bytes = test::resized(whole, whole.span().size());
      bytes.span()[i] ^= static_cast<std::byte>(flip);
      test::reseal(bytes);
      const Result<RoomMap> opened = open(bytes);
      if (!opened.ok()) continue;
      ++opened_count;
      const MapData read = tools::to_map_data(opened.value());
      for (const MapMarker& marker : read.markers) EXPECT_TRUE(marker.p_room.allFinite() && marker.cov_m2.allFinite());
    }
  }
  EXPECT_GT(opened_count, 0U) << "low bits of a coordinate change nothing that a check could see";
}

TEST(RoomMap, AnyTruncationUnderValidSums_IsRefusedOrSafeToRead) {
  const AlignedBytes whole = tools::build_map(test::small_map());
  for (std::size_t size = 0; size < whole.span().size(); ++size) {
    AlignedBytes bytes = test::resized(whole, size);
    test::reseal(bytes);
    if (const Result<RoomMap> opened = open(bytes); opened.ok()) static_cast<void>(tools::to_map_data(opened.value()));
  }
}

TEST(RoomMap, ThreeHundredFortyMarkersWithTriangles_FitIn64KiB) {
  MapData data;
  data.id = "full room";
  data.provenance = std::string(100, 'p');
  for (uint32_t i = 0; i < 340; ++i) {
    MapMarker marker;
    marker.id = i;
    marker.p_room = Vec3(0.01 * i, 0.1, 0.2);
    data.markers.push_back(marker);
  }
  for (uint16_t i = 0; i < 6000; ++i) {
    const auto a = static_cast<uint16_t>(i % 338);
    data.triangles.push_back({a, static_cast<uint16_t>(a + 1), static_cast<uint16_t>(a + 2)});
  }
  for (int i = 0; i < 12; ++i) data.planes.push_back({{}, std::vector<Vec3>(12, Vec3::Zero())});
  EXPECT_LE(tools::build_map(data).span().size(), 64U * 1024);
}

}  // namespace
}  // namespace roomcal::map
