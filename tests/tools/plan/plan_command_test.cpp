#include "tools/plan/plan_command.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/folder_test.h"
#include "tests/tools/refusal.h"
#include "tools/common/files.h"

namespace roomcal::tools {
namespace {

namespace fs = std::filesystem;

class PlanCommand : public test::FolderTest {
 protected:
  /// Runs `roomcal plan <words>`. @return its exit code.
  static int run(std::vector<std::string> words) {
    CLI::App app;
    int exit_code = 0;
    add_plan_command(app, exit_code);
    words.insert(words.begin(), "plan");
    std::reverse(words.begin(), words.end());  // CLI11 wants them so
    app.parse(words);
    return exit_code;
  }
  static std::string refused(const std::vector<std::string>& words) {
    return test::refusal([&] { run(words); });
  }
};

TEST_F(PlanCommand, SameSeedTwice_GivesTheSameFiles) {
  for (const char* name : {"a", "b"}) {
    EXPECT_EQ(run({"--room", "2x2x2", "--sheets", "30", "-o", file(fmt::format("{}.csv", name)), "--drawing",
                   file(fmt::format("{}.pdf", name)), "--json", file(fmt::format("{}.json", name))}),
              0);
  }
  for (const char* kind : {"csv", "pdf", "json"}) {
    EXPECT_EQ(read_text(file(fmt::format("a.{}", kind))), read_text(file(fmt::format("b.{}", kind)))) << kind;
  }
}

TEST_F(PlanCommand, Drawing_HoldsEverySheetAndItsPlace) {
  run({"--room", "2x2x2", "--sheets", "30", "-o", file("a.csv"), "--drawing", file("a.pdf"), "--json", file("a.json")});
  const std::string command = fmt::format("pdftotext -raw '{}' '{}'", file("a.pdf"), file("a.txt"));
  ASSERT_EQ(std::system(command.c_str()), 0) << "pdftotext is needed: tools/setup --tests";
  const std::string text = read_text(file("a.txt"));
  const auto plan = nlohmann::json::parse(read_text(file("a.json")));
  for (const auto& wall : plan["walls"]) {
    EXPECT_TRUE(test::contains(text, wall["name"].get<std::string>()));
    for (const auto& sheet : wall["sheets"]) {
      const std::string place = fmt::format("{:.0f} | {:.0f}", 100 * sheet["from_left_m"].get<double>(),
                                            100 * sheet["from_bottom_m"].get<double>());
      EXPECT_TRUE(test::contains(text, place)) << sheet["id"] << ": " << place;
    }
  }
}

TEST_F(PlanCommand, WallsFromAFile_KeepTheDoorFree) {
  std::ofstream(folder_ / "w.yaml")
      << "walls:\n"
         "  - {name: a, corner: [3, 0, 0], right: [-1, 0, 0], size: [3, 2.5], "
         "keep_out: [[1, 0, 2, 2]]}\n"
         "  - {name: b, corner: [0, 0, 0], right: [0, 1, 0], size: [3, 2.5]}\n"
         "  - {name: floor, corner: [0, 0, 0], right: [1, 0, 0], up: [0, 1, 0], size: [3, 3]}\n";
  EXPECT_EQ(run({"--walls", file("w.yaml"), "--sheets", "60", "-o", file("a.csv"), "--json", file("a.json")}), 0);
  const auto plan = nlohmann::json::parse(read_text(file("a.json")));
  for (const auto& sheet : plan["walls"][0]["sheets"]) {
    const double x = sheet["from_left_m"], y = sheet["from_bottom_m"];
    EXPECT_FALSE(x > 0.9 && x < 2.1 && y < 2) << sheet;
  }
}

TEST_F(PlanCommand, TargetMissed_ExitsTwo) {
  EXPECT_EQ(run({"--room", "2x2x2", "--paper", "a3", "--target", "100", "-o", file("a.csv")}), 2);
  EXPECT_TRUE(fs::exists(file("a.csv")));
}

TEST_F(PlanCommand, BadInput_IsNamedAndWritesNothing) {
  const std::string out = file("a.csv");
  EXPECT_TRUE(test::contains(refused({"--room", "0.5x0.5x0.5", "-o", out}), "each 1 to 50 m"));
  EXPECT_TRUE(test::contains(refused({"-o", out}), "--room 3x4x2.7 or by --walls"));
  EXPECT_TRUE(test::contains(refused({"--room", "3x4x2", "--walls", "x", "-o", out}), "--room 3x4x2.7 or by --walls"));
  EXPECT_TRUE(test::contains(refused({"--walls", file("none"), "-o", out}), "no such file"));
  EXPECT_TRUE(test::contains(refused({"--room", "3x4x2.7", "--radius", "100", "-o", out}), "a4 holds 10 to 85 mm"));
  EXPECT_TRUE(test::contains(refused({"--room", "3x4x2.7", "--fov", "nan", "-o", out}), "--fov"));
  EXPECT_TRUE(test::contains(refused({"--room", "2x2x2", "--sheets", "4000", "-o", out}), "only"));
  EXPECT_FALSE(fs::exists(out));
  EXPECT_TRUE(test::contains(refused({"--room", "2x2x2", "--sheets", "20", "-o", "/proc/nowhere/a.csv"}),
                             "/proc/nowhere/a.csv"));
}

}  // namespace
}  // namespace roomcal::tools
