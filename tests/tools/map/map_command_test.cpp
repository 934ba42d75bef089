#include "tools/map/map_command.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "runtime/math/se3.h"
#include "tests/tools/folder_test.h"
#include "tests/tools/map/box_room.h"
#include "tests/tools/refusal.h"
#include "tools/common/files.h"
#include "tools/map/map_builder.h"

namespace roomcal::tools {
namespace {

namespace fs = std::filesystem;

class MapCommand : public test::FolderTest {
 protected:
  void write_csv(const std::string& name, const std::vector<map::MapMarker>& markers) const {
    std::ofstream out(folder_ / name);
    out.precision(17);
    out << "id,x,y,z\n";
    for (const map::MapMarker& m : markers) {
      out << m.id << ',' << m.p_room.x() << ',' << m.p_room.y() << ',' << m.p_room.z() << '\n';
    }
  }

  /// Runs `roomcal <words>`; throws what the command throws.
  static void run(std::vector<std::string> words) {
    CLI::App app;
    int exit_code = 0;
    add_map_command(app, exit_code);
    std::reverse(words.begin(), words.end());  // CLI11 wants them so
    app.parse(words);
  }
};

TEST_F(MapCommand, ImportInfoNoise_AgreeOnTheMarkers) {
  const MapData room = test::box_room(20, 0.001, 1);
  write_csv("m.csv", room.markers);
  run({"map", "import", file("m.csv"), "-o", file("m.room"), "--radius", "0.085", "--sigma", "0.002", "--id", "lab"});
  run({"map", "noise", file("m.room"), "--sigma", "0.01", "--seed", "3", "-o", file("n.room")});
  run({"map", "info", file("m.room"), "--json", file("m.json")});
  const LoadedMap exact = load_map(file("m.room")), noisy = load_map(file("n.room"));
  ASSERT_EQ(exact.map.marker_count(), 100U);
  EXPECT_EQ(exact.map.marker(17).p_room, room.markers[17].p_room);
  EXPECT_NE(noisy.map.marker(17).p_room, room.markers[17].p_room);
  EXPECT_NEAR(noisy.map.marker(17).cov_m2(1, 1), 104e-6, 1e-9);
  const auto info = nlohmann::json::parse(read_text(file("m.json")));
  EXPECT_EQ(info["id"], "lab");
  EXPECT_EQ(info["markers"], 100);
  EXPECT_EQ(info["with_radius"], 100);
  EXPECT_EQ(info["bytes"], fs::file_size(file("m.room")));
  EXPECT_EQ(info["planes"].size(), 5U);
  EXPECT_NEAR(info["sigma_m"]["max"].get<double>(), 0.002, 1e-9);
  EXPECT_GT(info["uniqueness"]["worst_mm"].get<double>(), 1);
}

TEST_F(MapCommand, ImportTwice_GivesTheSameContent) {
  write_csv("m.csv", test::box_room(20, 0.001, 2).markers);
  run({"map", "import", file("m.csv"), "-o", file("a.room"), "--id", "x"});
  run({"map", "import", file("m.csv"), "-o", file("b.room"), "--id", "x"});
  EXPECT_EQ(load_map(file("a.room")).map.content_crc32c(), load_map(file("b.room")).map.content_crc32c());
}

TEST_F(MapCommand, HiddenNoise_LeavesTheCovariance) {
  write_csv("m.csv", test::box_room(20, 0, 3).markers);
  run({"map", "import", file("m.csv"), "-o", file("a.room")});
  run({"map", "noise", file("a.room"), "--sigma", "0.01", "--no-declare", "-o", file("b.room")});
  EXPECT_EQ(load_map(file("b.room")).map.marker(0).cov_m2, Mat33::Zero());
}

TEST_F(MapCommand, BadInput_IsRefusedAndWritesNothing) {
  std::ofstream(folder_ / "bad.csv") << "id,x,y,z\n1,nan,2,3\n";
  const std::string message = test::refusal([&] { run({"map", "import", file("bad.csv"), "-o", file("bad.room")}); });
  EXPECT_TRUE(test::contains(message, "bad.csv:2: x:")) << message;
  EXPECT_FALSE(fs::exists(file("bad.room")));
  EXPECT_TRUE(test::contains(test::refusal([&] { run({"map", "info", file("none.room")}); }), "no such file"));
  EXPECT_TRUE(test::contains(test::refusal([&] { run({"map", "info", file("bad.csv")}); }), "not a room map"));
}

TEST_F(MapCommand, BadOptions_AreRefused) {
  write_csv("m.csv", test::box_room(20, 0, 3).markers);
  for (const std::string value : {"-1", "nan", "abc", "100"}) {
    EXPECT_THROW(run({"map", "import", file("m.csv"), "-o", file("a.room"), "--sigma", value}), CLI::ParseError)
        << value;
    EXPECT_THROW(run({"map", "import", file("m.csv"), "-o", file("a.room"), "--radius", value}), CLI::ParseError)
        << value;
  }
}

TEST_F(MapCommand, PapersRoom_ImportsWithFivePlanes) {
  const char* data = std::getenv("ROOMCAL_DATA");
  const fs::path root = data != nullptr ? fs::path(data) : fs::path(ROOMCAL_SOURCE_DIR) / "../shared/data";
  const fs::path map = root / "anchor-room/map_2021-01.yaml";
  if (!fs::exists(map)) GTEST_SKIP() << map << " is not here; set ROOMCAL_DATA";
  run({"map", "import", map.string(), "-o", file("paper.room")});
  const LoadedMap loaded = load_map(file("paper.room"));
  EXPECT_EQ(loaded.map.marker_count(), 335U);
  EXPECT_EQ(loaded.map.plane_count(), 5U);
  for (std::size_t i = 0; i < loaded.map.marker_count(); ++i) EXPECT_TRUE(loaded.map.marker(i).normal_estimated);
}

TEST_F(MapCommand, Compare_SaysInJsonHowMapsDiffer) {
  const MapData room = test::box_room(20, 0, 7);
  write_csv("a.csv", room.markers);
  std::vector<map::MapMarker> changed = room.markers;
  const SE3 T_b_a{so3_exp({0.1, -0.2, 0.9}), Vec3(1, 2, -0.5)};
  for (map::MapMarker& marker : changed) {
    marker.p_room = T_b_a * marker.p_room;
    marker.id += 1000;  // identities are not used
  }
  changed[3].p_room += Vec3(0.02, 0, 0);
  changed.erase(changed.begin() + 50);
  write_csv("b.csv", changed);
  run({"map", "compare", file("a.csv"), file("b.csv"), "--json", file("c.json")});
  const auto json = nlohmann::json::parse(read_text(file("c.json")));
  EXPECT_EQ(json["matched"], 99);
  EXPECT_NEAR(json["max_mm"].get<double>(), 20, 1);
  EXPECT_NEAR(json["rms_mm"].get<double>(), 20 / std::sqrt(99.0), 0.2);
  EXPECT_LT(json["mean_mm"].get<double>(), json["rms_mm"].get<double>());
  EXPECT_NEAR(json["scale_a_b"].get<double>(), 1, 1e-3);
  EXPECT_EQ(json["only_in_a"], nlohmann::json::array({50}));
  EXPECT_TRUE(json["only_in_b"].empty());
  EXPECT_EQ(json["planes"].size(), 5U);
  for (const auto& plane : json["planes"]) EXPECT_LT(plane["angle_deg"].get<double>(), 0.2);
}

TEST_F(MapCommand, CompareOfTwoRooms_MatchesNothing) {
  write_csv("a.csv", test::box_room(20, 0, 8).markers);
  write_csv("b.csv", test::box_room(20, 0, 9).markers);
  run({"map", "compare", file("a.csv"), file("b.csv"), "--json", file("c.json")});
  EXPECT_EQ(nlohmann::json::parse(read_text(file("c.json")))["matched"], 0);
}

}  // namespace
}  // namespace roomcal::tools
