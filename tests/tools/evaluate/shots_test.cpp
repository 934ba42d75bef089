// A reduced set of `roomcal evaluate --shots` and `--rendered`, and what their figures are made of.
#include <array>
#include <filesystem>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tools/common/files.h"
#include "tools/evaluate/evaluation_document.h"
#include "tools/evaluate/shots_command.h"
#include "tools/evaluate/shots_report.h"

namespace roomcal::tools {
namespace {

TEST(Shots, AFewOfEveryKind_AreRefusedOrRight) {
  const ShotTallies tallies = run_observed_shots(3, 28, 2);
  int shots = 0, refused = 0;
  for (const ShotKind kind : kShotKinds) {
    const ShotTally& tally = tallies[static_cast<std::size_t>(kind)];
    EXPECT_GE(tally.shots, 2) << to_string(kind);
    EXPECT_EQ(tally.wrong, 0) << to_string(kind);
    shots += tally.shots;
    refused += tally.shots - tally.accepted;
  }
  EXPECT_EQ(shots, 28);
  EXPECT_GT(refused, 5);
  EXPECT_TRUE(all_met(bars_of(tallies))) << report_of(tallies);
}

TEST(Shots, SameSeed_GivesTheSameFigures) {
  int so_far = 0;
  std::string kept;
  const std::string report = report_of(run_observed_shots(5, 2, 2, [&](int shots, const ShotTallies& tallies) {
    so_far = shots;
    kept = report_of(tallies);
  }));
  EXPECT_EQ(so_far, 2);
  EXPECT_EQ(kept, report);
  EXPECT_EQ(report, report_of(run_observed_shots(5, 2, 2)));
  EXPECT_NE(report, report_of(run_observed_shots(6, 2, 2)));
}

TEST(Shots, RenderedOnes_AgreeWithTheSameShotsObserved) {
  const std::array kinds = {ShotKind::kClean};
  const RenderedTallies both = run_rendered_shots(2, 2, kinds);
  for (const ShotTally* tally : {&both.rendered[0], &both.observed[0]}) {
    EXPECT_EQ(tally->shots, 2);
    EXPECT_EQ(tally->accepted, 2);
    EXPECT_EQ(tally->wrong, 0);
    EXPECT_LT(tally->cameras.worst_m, 0.001);
    EXPECT_LT(tally->lidars.worst_m, 0.005);
  }
  EXPECT_NE(report_of(both).find("| clean, rendered | 2 | 2 | 0 | 0 |"), std::string::npos) << report_of(both);
}

/// An accepted outcome of a device with two cameras, the second one off by this and sure of itself by that.
ShotResult judged(double off_m, double sigma_m) {
  TrustDevice device;
  const auto made = std::make_unique<calib::Outcome>();
  calib::Outcome& outcome = *made;
  outcome.verdict = calib::Verdict::kPass;
  for (const char* name : {"cam0", "cam1"}) {
    calib::CameraSpec spec;
    spec.name = std::string_view(name);
    EXPECT_TRUE(device.device.cameras.push_back(spec));
    device.T_rig_sensor.emplace_back();
    calib::CameraOutcome camera;
    camera.name = spec.name;
    camera.located = camera.in_rig = true;
    EXPECT_TRUE(outcome.cameras.push_back(camera));
  }
  outcome.cameras[1].T_rig_cam.t.x() = off_m;
  outcome.cameras[1].cov_rig_cam = sigma_m * sigma_m * Mat66::Identity();
  return result_of(outcome, device);
}

TEST(Shots, Wrong_IsLargeAndBeyondItsSigmas) {
  EXPECT_TRUE(judged(0.004, 0.0007).wrong);
  EXPECT_FALSE(judged(0.004, 0.0009).wrong);  // its covariance said so
  EXPECT_FALSE(judged(0.002, 0.0001).wrong);  // too small to harm
  EXPECT_NEAR(judged(0.004, 0.0007).worst_sigmas, 4 / 0.7, 1e-9);
  EXPECT_NEAR(judged(0.004, 0.001).cameras.nees, 16, 1e-9);
  EXPECT_EQ(judged(0.004, 0.001).cameras.count, 1);
}

TEST(Shots, ReasonsClass_HasNeitherNamesNorNumbers) {
  EXPECT_EQ(class_of("cam2: 63 % of its 84 markers are not where the map has them (limit 30 %): is this the map?"),
            "# % of its # markers are not where the map has them (limit # %)");
  EXPECT_EQ(class_of("lidar0: sits 12.4 mm and 0.31 deg from its nominal mounting: check its bracket"),
            "sits # mm and # deg from its nominal mounting");
}

TEST(Shots, BarNotMet_IsExitStatusTwoAndSaidSo) {
  ShotTallies tallies;
  ShotResult result;
  result.accepted = true;
  tallies[0].add(result);
  EXPECT_TRUE(all_met(bars_of(tallies)));
  result.wrong = true;
  tallies[1].add(result);
  EXPECT_FALSE(all_met(bars_of(tallies)));
  EXPECT_NE(report_of(tallies).find("| 1 of 2 accepted | **no** |"), std::string::npos);
}

class ShotsCommand : public testing::Test {
 protected:
  /// @return exit status; what it printed goes into `printed_`.
  int run(const std::string& arguments) {
    int exit_code = 0;
    CLI::App app;
    app.add_subcommand("detector");
    app.require_subcommand(0, 1);
    add_evaluate_shots(app, exit_code);
    testing::internal::CaptureStdout();
    try {
      app.parse(arguments);
    } catch (const CLI::ParseError& error) {
      exit_code = error.get_exit_code();
    }
    printed_ = testing::internal::GetCapturedStdout();
    return exit_code;
  }
  std::string printed_;
};

TEST_F(ShotsCommand, Document_GetsWhatIsPrintedWithSeedAndCommand) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / ("roomcal_shots_" + std::to_string(getpid()) + ".md");
  EXPECT_EQ(run("--shots 1 --seed 4 --document " + file.string()), 0);
  const std::string text = read_text(file);
  std::filesystem::remove(file);
  EXPECT_NE(text.find("`roomcal evaluate --shots 1 --seed 4` at commit `"), std::string::npos);
  EXPECT_NE(text.find("1 shots, seed 4"), std::string::npos);
  EXPECT_NE(text.find("`roomcal evaluate --shots 10000 --seed 4`"), std::string::npos);
  EXPECT_NE(text.find(printed_.substr(0, printed_.find('\n'))), std::string::npos);
}

TEST_F(ShotsCommand, NothingAskedOrTwoThings_IsACommandLineError) {
  EXPECT_GE(run(""), 100);
  EXPECT_GE(run("--seed 3"), 100);
  EXPECT_GE(run("--shots 3 detector"), 100);
}

}  // namespace
}  // namespace roomcal::tools
