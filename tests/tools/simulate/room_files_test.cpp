#include "tools/simulate/room_files.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/simulate/make_room.h"
#include "tools/simulate/room_walls.h"

namespace roomcal::tools {
namespace {

class RoomFiles : public testing::Test {
 protected:
  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("roomcal_room_files_" + std::to_string(getpid()));
  void TearDown() override { std::filesystem::remove_all(folder_); }
};

TEST_F(RoomFiles, WrittenAndRead_IsTheSameRoom) {
  const Scene scene = make_room({.seed = 9, .markers = 60, .pillar = true, .boxes = 1});
  write_room(scene, folder_);
  const Scene again = read_room(folder_);
  const auto a = markers_of(scene), b = markers_of(again);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].centre_room, b[i].centre_room);
  EXPECT_EQ(again.bodies.size(), 2u);
  EXPECT_EQ(again.lamps.size(), scene.lamps.size());
  EXPECT_EQ(again.walls.front().tile_m, scene.walls.front().tile_m);
}

TEST_F(RoomFiles, DrawnWallsWavesAndFurniture_ComeBack) {
  RoomOptions options{.seed = 3, .markers = 40};
  options.waviness_m = 0.002;
  options.furniture = 4;
  options.walls = box_walls("3x4x2.5", true);
  for (Wall& wall : options.walls) wall.corner_room += Vec3(-1, 2, 0.5);
  const Scene scene = make_room(options);
  write_room(scene, folder_);
  const Scene again = read_room(folder_);
  EXPECT_TRUE(again.bounded());
  EXPECT_EQ(again.low, scene.low);
  EXPECT_EQ(again.size, scene.size);
  ASSERT_EQ(again.walls.size(), scene.walls.size());
  for (std::size_t i = 0; i < scene.walls.size(); ++i)
    EXPECT_EQ(again.walls[i].height({0.7, 0.9}), scene.walls[i].height({0.7, 0.9}));
  ASSERT_EQ(again.bodies.size(), scene.bodies.size());
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    EXPECT_NEAR(again.bodies[i].reach_m, scene.bodies[i].reach_m, 1e-9);
  const auto planes = nlohmann::json::parse(read_text(folder_ / "planes.json")).at("planes");
  EXPECT_NEAR(planes[1].at("wave_sigma_m").get<double>(), waviness_of(scene.walls[1]).sigma_m, 1e-12);
  EXPECT_GT(planes[1].at("wave_sigma_m").get<double>(), 0.0005);
}

TEST_F(RoomFiles, Csv_HasOneLinePerMarker) {
  write_room(make_room({.markers = 60}), folder_);
  const std::string text = read_text(folder_ / "markers.csv");
  EXPECT_EQ(text.substr(0, text.find('\n')), "id,x,y,z,nx,ny,nz,radius");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 61);
}

TEST_F(RoomFiles, Planes_HoldTheMarkers) {
  const Scene scene = make_room({.markers = 60});
  write_room(scene, folder_);
  const auto planes = nlohmann::json::parse(read_text(folder_ / "planes.json")).at("planes");
  for (const SceneMarker& marker : markers_of(scene)) {
    double nearest = 1;
    for (const auto& plane : planes) {
      const auto n = plane.at("normal");
      const Vec3 normal(n[0].get<double>(), n[1].get<double>(), n[2].get<double>());
      nearest = std::min(nearest, std::abs(normal.dot(marker.centre_room) + plane.at("d").get<double>()));
    }
    EXPECT_LT(nearest, 1e-9);
  }
}

TEST_F(RoomFiles, DamagedRoom_NamesTheFile) {
  std::filesystem::create_directories(folder_);
  for (const char* text : {"", "{", "{}", "{\"format\": \"other\"}", "[1, 2]"}) {
    write_atomic(folder_ / "room.json", std::string(text));
    try {
      read_room(folder_);
      FAIL() << text;
    } catch (const ToolError& error) {
      EXPECT_NE(std::string(error.what()).find("room.json"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace roomcal::tools
