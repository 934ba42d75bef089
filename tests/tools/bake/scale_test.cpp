#include "tools/bake/scale.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/tools/refusal.h"

namespace roomcal::tools {
namespace {

using test::contains;
using test::refusal;

/// Two markers 2 m apart, seen at (100, 100) and (300, 100) of pair "7".
struct TwoMarkers {
  Survey survey;
  Reconstruction map;
  std::vector<uint32_t> ids{4, 9};

  TwoMarkers() {
    StereoView view;
    view.name = "7";
    view.seen[kLeft] = {{Vec2(100, 100), Mat22::Identity(), {}}, {Vec2(300, 100), Mat22::Identity(), {}}};
    survey.views.push_back(view);
    map.views.resize(1);
    map.views[0].placed = true;
    map.views[0].point[kLeft] = {0, 1};
    map.add_point({Vec3::Zero(), Mat33::Identity()});
    map.add_point({Vec3(2, 0, 0), Mat33::Identity()});
  }

  std::vector<MeasuredDistance> read(const std::string& csv) const {
    const auto path =
        std::filesystem::path(testing::TempDir()) /
        (std::string("roomcal_distances_") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv");
    std::ofstream(path) << csv;
    return read_distances(path, survey, map, ids);
  }
};

std::vector<std::optional<MarkerShape>> shapes_of(double radius_m) {
  MarkerShape shape;
  shape.radius_m = radius_m;
  return {shape, shape, shape};
}

TEST(ReadDistances, IdsAndPlaces_NameTheSameMarkers) {
  const TwoMarkers two;
  for (const char* line :
       {"4,9,2.01", "# by tape\na,b,distance_m\n7@103:98,9,2.01,0.002", "7@100:100,7@300:100,2.01"}) {
    const auto distances = two.read(line);
    ASSERT_EQ(distances.size(), 1U) << line;
    EXPECT_EQ(distances[0].point_a, 0U);
    EXPECT_EQ(distances[0].point_b, 1U);
    EXPECT_EQ(distances[0].distance_m, 2.01);
  }
}

TEST(ReadDistances, BadLines_AreNamedWithTheirNumber) {
  const TwoMarkers two;
  const std::vector<std::pair<const char*, const char*>> cases{{"4,9", "1: expected a,b,distance_m"},
                                                               {"4,9,-1", "metres above 0"},
                                                               {"4,9,2,0", "sigma_m"},
                                                               {"4,4,2", "the same marker"},
                                                               {"4,5,2", "the map has no marker 5"},
                                                               {"7@500:500,9,2", "no marker of the map"},
                                                               {"8@1:1,9,2", "the survey has no pair 8"},
                                                               {"7@x,9,2", "expected x:y"},
                                                               {"\n", "no distance in it"}};
  for (const auto& [csv, words] : cases) {
    const std::string said = refusal([&] { two.read(csv); });
    EXPECT_TRUE(contains(said, words)) << csv << ": " << said;
  }
}

TEST(JudgeScale, MeasuredDistance_SetsTheFactorAndSaysThatScaleIsOff) {
  const TwoMarkers two;
  const ScaleReport report = judge_scale(two.map, two.read("4,9,2.01,0.001"), {}, {});
  EXPECT_NEAR(report.factor, 1.005, 1e-12);
  EXPECT_NEAR(report.sigma, 0.0005, 1e-12);
  EXPECT_TRUE(report.off);
  EXPECT_EQ(report.source, "distances");
}

TEST(JudgeScale, MarkerRadius_SetsTheFactor) {
  ScaleOptions options;
  options.marker_radius_m = 0.0860;
  const ScaleReport report = judge_scale({}, {}, shapes_of(0.0850), options);
  EXPECT_NEAR(report.factor, 86.0 / 85.0, 1e-9);
  EXPECT_TRUE(report.off);
}

TEST(JudgeScale, TrustedBaseline_OnlyHintsAtSheets) {
  const ScaleReport report = judge_scale({}, {}, shapes_of(0.085 * 1.0028), {});
  EXPECT_EQ(report.factor, 1);
  EXPECT_TRUE(report.off);
  EXPECT_TRUE(contains(report.message, "scale is off, if"));
}

TEST(JudgeScale, DoubtedBaseline_IsWeighedAgainstSheets) {
  ScaleOptions options;
  options.baseline_sigma = 0.003;
  const ScaleReport report = judge_scale({}, {}, shapes_of(0.085 * 1.0028), options);
  EXPECT_NEAR(report.factor, 1 - 0.0025, 2e-4);
  EXPECT_TRUE(report.off);
}

TEST(JudgeScale, DoubtedBaselineAndNoSheets_TakesTheMeanOfWhatTheCalibrationSays) {
  ScaleOptions options;
  options.baseline_sigma = 0.003;
  options.scale_as_given = 1.002;
  const ScaleReport report = judge_scale({}, {}, {}, options);
  EXPECT_NEAR(report.factor, 1.001, 1e-12);
  EXPECT_FALSE(report.off);
  EXPECT_EQ(report.source, "stereo calibration");
}

}  // namespace
}  // namespace roomcal::tools
