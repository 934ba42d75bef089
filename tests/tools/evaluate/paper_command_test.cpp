#include "tools/evaluate/paper_command.h"

#include <cmath>
#include <filesystem>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "tools/common/files.h"
#include "tools/evaluate/baseline_bound.h"
#include "tools/evaluate/noise_picture.h"
#include "tools/evaluate/paper_figures.h"
#include "tools/evaluate/paper_trial.h"
#include "tools/evaluate/spread.h"
#include "tools/evaluate/tag_view.h"

namespace roomcal::tools {
namespace {

nlohmann::json run(const std::string& arguments, int& exit_code) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("roomcal_evaluate_paper_" + std::to_string(getpid()) + ".json");
  CLI::App app;
  add_evaluate_paper(app, exit_code);
  testing::internal::CaptureStdout();
  app.parse("paper --json " + file.string() + " " + arguments);
  const std::string printed = testing::internal::GetCapturedStdout();
  EXPECT_NE(printed.find("Wrong extrinsics that would be written: 0."), std::string::npos) << printed;
  const auto text = read_text(file);
  std::filesystem::remove(file);
  return nlohmann::json::parse(text);
}

std::vector<std::string> column(const nlohmann::json& table, const std::string& heading) {
  const std::vector<std::vector<std::string>> rows = table["rows"];
  std::vector<std::string> cells;
  for (std::size_t k = 0; k < rows[0].size(); ++k) {
    if (rows[0][k] != heading) continue;
    for (std::size_t row = 1; row < rows.size(); ++row) cells.push_back(rows[row][k]);
    return cells;
  }
  ADD_FAILURE() << "no column " << heading;
  return cells;
}

TEST(EvaluatePaper, OneShotOfEveryDevice_FillsEveryPairAndBeatsThePaper) {
  int exit_code = 0;
  const nlohmann::json tables = run("--rooms 1 --shots 1 --experiments devices", exit_code);
  ASSERT_EQ(tables.size(), 1U);
  const std::vector<std::string> success = column(tables[0], "success");
  ASSERT_EQ(success.size(), 1U + 10 + 15 + 3);  // pairs of the stereo rig, robot, backpack, scanner
  for (const std::string& of : success) EXPECT_EQ(of, "1 of 1");
  for (const std::string& mm : column(tables[0], "ours mm")) EXPECT_GT(std::stod(mm), 0);
  EXPECT_EQ(tables[0]["worse"].size(), 0U) << tables[0]["worse"];
  EXPECT_EQ(exit_code, 0);
}

TEST(EvaluatePaper, UnknownExperimentOrPartOfADocument_IsRefused) {
  int exit_code = 0;
  CLI::App app;
  add_evaluate_paper(app, exit_code);
  EXPECT_THROW(app.parse("paper --experiments magic"), CLI::ValidationError);
  EXPECT_THROW(app.parse("paper --experiments devices --document E.md"), CLI::ExcludesError);
}

TEST(PaperFigures, DistancesFromTheDrawing_AreThoseOfItsTables) {
  const PaperDevice& robot = device_named("mobile_robot");
  const auto camera = paper_distance(robot, "cam1", "cam0");
  ASSERT_TRUE(camera.has_value());
  EXPECT_NEAR(1e3 * camera->position_m, std::hypot(0.4, 0.3, 2.9), 1e-9);  // (5.61, 0.03, 5.36) - (5.65, 0, 5.65) cm
  EXPECT_NEAR(rad_to_deg(camera->rotation_rad), 0.4, 0.1);
  EXPECT_FALSE(paper_distance(robot, "cam2", "cam1").has_value());
  ASSERT_EQ(paper_noise_rows().size(), 3U);
  EXPECT_NEAR(1e3 * paper_noise_rows()[0].camera_lidar.position_m, std::hypot(8.1, 7.3, 9.17), 1e-2);
  EXPECT_NEAR(1e3 * paper_noise_rows()[2].lidar_lidar_m, std::hypot(25.3, 6.4, 1.5), 1e-2);
}

TEST(Spread, FourNumbers_HaveMeanDeviationRmsAndWorst) {
  const Spread spread = spread_of({1, -3, 2, 4}, 10);
  EXPECT_NEAR(spread.mean, 10, 1e-12);
  EXPECT_NEAR(spread.sd, 10 * std::sqrt(26.0 / 3), 1e-12);
  EXPECT_NEAR(spread.rms, 10 * std::sqrt(7.5), 1e-12);
  EXPECT_NEAR(spread.worst, 40, 1e-12);
  EXPECT_EQ(spread_of({}).worst, 0);
}

TEST(BaselineBound, NoiseOfRingsAndMap_RaiseItAndScaleIt) {
  const TrustRoom room(1);
  const PaperStand stand = stand_in(room, "stereo_rig", 1);
  PaperShot shot = take_paper_shot(room, stand, 1);
  const double exact_m = baseline_bound_m(room.scene(), stand.stand, shot.rings, 0);
  const double noisy_m = baseline_bound_m(room.scene(), stand.stand, shot.rings, 0.005);
  EXPECT_GT(exact_m, 0);
  EXPECT_GT(noisy_m, exact_m);
  for (std::vector<marker::Detection>& rings : shot.rings)
    for (marker::Detection& ring : rings) ring.cov_px2 *= 4;
  EXPECT_NEAR(baseline_bound_m(room.scene(), stand.stand, shot.rings, 0), 2 * exact_m, 1e-9);
  EXPECT_NEAR(baseline_bound_m(room.scene(), stand.stand, shot.rings, 0.010), 2 * noisy_m, 1e-9);
}

TEST(TagView, SmallPicture_HasWholeTagsWhereTheirCornersAre) {
  if (!has_tags()) GTEST_SKIP() << "built without libapriltag (libapriltag-dev)";
  const TrustRoom room(1);
  PaperStand stand = stand_in(room, "stereo_rig", 1);
  TrueCamera& camera = stand.stand.cameras[0];
  camera.camera = camera::Camera::create(scaled(device_named("stereo_rig"), 0.4).cameras[0].nominal).value();
  const Scene blank = with_blank_sheets(room.scene());
  const LitScene lit(blank);
  const TagView view(lit, room.scene(), camera.camera, camera.T_room_cam);
  const cv::Mat image = develop(expose_view(view, view.blank().paper_radiance_quantile(0.9), camera, {}), 1).image;
  std::map<int, std::array<Vec3, 4>> corners_room;
  for (const Plane& wall : room.scene().walls)
    for (const Decal& decal : wall.decals)
      if (decal.print == Print::kRings) corners_room[decal.marker_id] = tag_corners_room(wall, decal);
  const std::vector<TagDetection> tags = find_tags(image);
  EXPECT_GE(tags.size(), 8U);
  Vec2 mean_px = Vec2::Zero();
  for (const TagDetection& tag : tags) {
    ASSERT_TRUE(corners_room.contains(tag.id));
    for (std::size_t k = 0; k < 4; ++k) {
      Vec2 px;
      ASSERT_TRUE(camera.camera.project(camera.T_room_cam.inverse() * corners_room[tag.id][k], px).ok());
      EXPECT_LT((tag.corners_px[k] - px).norm(), 1.5)
          << "tag " << tag.id << " corner " << k << " at " << px.transpose();
      EXPECT_TRUE(cv::Rect2d(0, 0, image.cols - 1, image.rows - 1).contains(cv::Point2d(px.x(), px.y())))
          << "tag " << tag.id << " is cut by the border";
      mean_px += (tag.corners_px[k] - px) / (4.0 * static_cast<double>(tags.size()));
    }
  }
  EXPECT_LT(mean_px.norm(), 0.15) << mean_px.transpose();  // its pixels begin where ours do
}

TEST(NoisePicture, EveryRow_IsAPointAndThePaperHasThree) {
  NoiseRow row;
  row.pair.position_m = row.pair.baseline_m = {0.001, 0.002};
  row.pair.nees = {6, 6};
  row.bound_m = 0.0005;
  NoiseRow refused;
  refused.map_sigma_m = 0.020;
  const std::string svg = noise_picture({{row, refused}, {row}, {row}});
  const auto count = [&](const std::string& part) {
    int n = 0;
    for (std::size_t at = svg.find(part); at != svg.npos; at = svg.find(part, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count("<circle"), 3 + 1);        // a row each and the legend; where nothing was located there is none
  EXPECT_EQ(count("width='9'"), 3 * 3 + 1);  // the paper's three noises in three panels and the legend
  EXPECT_EQ(svg.find("nan"), svg.npos);
  EXPECT_TRUE(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
}

}  // namespace
}  // namespace roomcal::tools
