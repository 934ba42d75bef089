#include "tools/map/map_builder.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/tools/map/box_room.h"
#include "tests/tools/refusal.h"
#include "tools/map/complete_map.h"

namespace roomcal::tools {
namespace {

bool same_bytes(const AlignedBytes& a, const AlignedBytes& b) {
  return std::equal(a.span().begin(), a.span().end(), b.span().begin(), b.span().end());
}

MapData full_room() {
  MapData data = test::box_room(68, 0.001, 9);
  complete_map(data);
  return data;
}

TEST(BuildMap, SameData_GivesTheSameBytes) { EXPECT_TRUE(same_bytes(build_map(full_room()), build_map(full_room()))); }

TEST(BuildMap, ReadAndBuiltAgain_GivesTheSameBytes) {
  const AlignedBytes bytes = build_map(full_room());
  const auto opened = map::RoomMap::open(bytes.span());
  ASSERT_TRUE(opened.ok());
  EXPECT_TRUE(same_bytes(build_map(to_map_data(opened.value())), bytes));
}

TEST(BuildMap, RoomOf340Markers_FitsIn64KiB) {
  const MapData data = full_room();
  ASSERT_EQ(data.markers.size(), 340U);
  EXPECT_GT(data.triangles.size(), 1000U);
  EXPECT_LE(build_map(data).span().size(), 64U * 1024);
}

TEST(LoadMap, DamagedFile_IsRefusedByName) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "damaged.room";
  AlignedBytes bytes = build_map(full_room());
  bytes.span()[100] ^= std::byte{4};
  write_atomic(path, bytes.span());
  const std::string message = test::refusal([&] { static_cast<void>(load_map(path)); });
  EXPECT_TRUE(test::contains(message, "damaged.room: corrupt: the content's checksum is wrong")) << message;
}

}  // namespace
}  // namespace roomcal::tools
