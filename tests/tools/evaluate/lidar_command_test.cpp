#include "tools/evaluate/lidar_command.h"

#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "tools/common/files.h"
#include "tools/evaluate/lidar_bars.h"

namespace roomcal::tools {
namespace {

nlohmann::json run(const std::string& arguments, const char* expected, int& exit_code) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("roomcal_evaluate_lidar_" + std::to_string(getpid()) + ".json");
  CLI::App app;
  add_evaluate_lidar(app, exit_code);
  testing::internal::CaptureStdout();
  app.parse("lidar --json " + file.string() + " " + arguments);
  EXPECT_NE(testing::internal::GetCapturedStdout().find(expected), std::string::npos);
  const auto bytes = read_text(file);
  std::filesystem::remove(file);
  return nlohmann::json::parse(bytes);
}

TEST(EvaluateLidar, TwoPoses_WritesEveryFigureOfEveryCell) {
  int exit_code = 0;
  const nlohmann::json result = run("--poses 2", "rms error", exit_code);
  ASSERT_EQ(result["cells"].size(), 9U);  // three ways to hold the sensor, three aids
  for (const nlohmann::json& cell : result["cells"]) {
    EXPECT_EQ(cell["poses"], 2);
    EXPECT_EQ(cell["observable"].get<int>() + cell["unobservable"].get<int>(), 2);
    EXPECT_LE(cell["found"].get<int>(), cell["observable"].get<int>());
    EXPECT_EQ(cell["wrong"], 0);
    EXPECT_EQ(cell["missed"], 0);
    for (const char* key :
         {"aid", "tilt", "ambiguous", "refused", "cautious", "closed_by_prints", "position_over_bound",
          "rotation_over_bound", "position_error_mm", "rotation_error_deg", "nees", "cpu_ms"}) {
      EXPECT_TRUE(cell.contains(key)) << key;
    }
  }
  ASSERT_EQ(result["bars"].size(), 8U);
  bool all_met = true;
  for (const nlohmann::json& bar : result["bars"]) {
    EXPECT_FALSE(bar["demand"].get<std::string>().empty());
    EXPECT_FALSE(bar["measured"].get<std::string>().empty());
    all_met = all_met && bar["met"].get<bool>();
  }
  EXPECT_EQ(exit_code, all_met ? 0 : 2);  // which of them are met, time among them, is not for two poses to say
}

TEST(EvaluateLidar, MethodGicp_PutsBothMethodsSideBySide) {
  int exit_code = 0;
  const nlohmann::json result = run("--method gicp --poses 2", "locate() is the more exact", exit_code);
  ASSERT_EQ(result["cells"].size(), 6U);
  for (std::size_t tilt = 0; tilt < 3; ++tilt) {
    const nlohmann::json &direct = result["cells"][tilt], &gicp = result["cells"][tilt + 3];
    EXPECT_EQ(direct["aid"], "prior");
    EXPECT_EQ(gicp["aid"], "gicp");
    EXPECT_EQ(direct["tilt"], gicp["tilt"]);
    EXPECT_EQ(direct["observable"], gicp["observable"]);  // the same sweeps
    EXPECT_EQ(gicp["missed"], 0);
  }
}

TEST(EvaluateLidar, NoPosesOrUnknownMethod_IsRefused) {
  int exit_code = 0;
  CLI::App app;
  add_evaluate_lidar(app, exit_code);
  EXPECT_THROW(app.parse("lidar --poses 0"), CLI::ValidationError);
  EXPECT_THROW(app.parse("lidar --method magic"), CLI::ValidationError);
}

LidarCell cell_with(LidarAid aid) {
  LidarCell cell;
  cell.aid = aid;
  cell.poses = 1000;
  cell.observable = cell.found = 900;
  cell.unobservable = 100;
  cell.position_squares = cell.rotation_squares = 900;
  cell.nees = 900 * 6;
  cell.ms = {10};
  return cell;
}

bool all_met(const LidarCell& with_prior, const LidarCell& without = cell_with(LidarAid::kPrints)) {
  for (const Bar& bar : judge_lidar({with_prior, cell_with(LidarAid::kPriorAndPrints), without})) {
    if (!bar.met) return false;
  }
  return true;
}

TEST(JudgeLidar, EachFigureBeyondItsBar_IsNotMet) {
  const LidarCell good = cell_with(LidarAid::kPrior);
  EXPECT_TRUE(all_met(good));
  LidarCell bad = good;
  bad.found = 890;
  EXPECT_FALSE(all_met(bad));
  bad = good;
  bad.position_squares *= 1.25 * 1.25;
  EXPECT_FALSE(all_met(bad));
  bad = good;
  bad.rotation_squares *= 1.25 * 1.25;
  EXPECT_FALSE(all_met(bad));
  bad = good;
  bad.missed = 1;
  EXPECT_FALSE(all_met(bad));
  bad = good;
  bad.wrong = 1;
  EXPECT_FALSE(all_met(bad));
  bad = good;
  bad.nees *= 1.4;
  EXPECT_FALSE(all_met(bad));
  bad = good;
  bad.ms = {16};
  EXPECT_FALSE(all_met(bad));
  bad = cell_with(LidarAid::kPrints);
  bad.ms = {16};
  EXPECT_FALSE(all_met(good, bad));
}

}  // namespace
}  // namespace roomcal::tools
