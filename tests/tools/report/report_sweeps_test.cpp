#include "tools/report/report_sweeps.h"

#include <cmath>
#include <memory>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "tools/evaluate/trust_shot.h"
#include "tools/simulate/random_stream.h"

namespace roomcal::tools {
namespace {

using Json = nlohmann::ordered_json;

/// A sweep of a simulated room by a LiDAR that stands where the result says.
class ReportSweeps : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    room_ = std::make_unique<TrustRoom>(1);
    device_ = std::make_unique<TrustDevice>(make_trust_device(*room_, 3));
    map_ = std::make_unique<LoadedMap>(open_map(room_->data()));
    T_room_rig_ = place_trust_device(*room_, 4);
    Random random = random_stream(5, 1);
    const TrustShot shot = take_trust_shot(*room_, *device_, T_room_rig_, {}, random);
    const lidar::Sweep view = shot.sweeps[0].view();
    sweeps_.push_back({{view.points.begin(), view.points.end()}, view});
    sweeps_[0].facts.points = {};
  }
  static void TearDownTestSuite() {
    sweeps_.clear();
    map_.reset();
    device_.reset();
    room_.reset();
  }

  static SensorResult lidar() {
    SensorResult sensor;
    sensor.name = "lidar0";
    sensor.T_room_sensor = T_room_rig_ * device_->T_rig_sensor[device_->device.cameras.size()];
    sensor.lidar.emplace();
    sensor.lidar->model = "vlp16";
    for (std::size_t b = 0; b < device_->beam_offset_m[0].size(); ++b)
      sensor.lidar->beam_offset_m[b] = device_->beam_offset_m[0][b];
    return sensor;
  }
  static SensorResult camera() {
    SensorResult sensor;
    sensor.T_room_sensor = T_room_rig_;
    sensor.camera = device_->lenses[0];
    return sensor;
  }

  static std::unique_ptr<TrustRoom> room_;
  static std::unique_ptr<TrustDevice> device_;
  static std::unique_ptr<LoadedMap> map_;
  static SE3 T_room_rig_;
  static std::vector<LoadedSweep> sweeps_;
};
std::unique_ptr<TrustRoom> ReportSweeps::room_;
std::unique_ptr<TrustDevice> ReportSweeps::device_;
std::unique_ptr<LoadedMap> ReportSweeps::map_;
SE3 ReportSweeps::T_room_rig_;
std::vector<LoadedSweep> ReportSweeps::sweeps_;

std::size_t counted(const Json& histogram) {
  const auto counts = histogram.at("counts").get<std::vector<std::size_t>>();
  return std::accumulate(counts.begin(), counts.end(), histogram.at("outside").get<std::size_t>());
}

/// RMS of the residuals within 3 sigma, mm.
double inner_rms_mm(const Json& sweep) {
  double sum = 0, count = 0;
  for (const Json& mm : sweep.at("residual_mm")) {
    if (mm.is_null() || std::abs(mm.get<double>()) > 3e3 * sweep.at("sigma_m").get<double>()) continue;
    sum += mm.get<double>() * mm.get<double>();
    ++count;
  }
  return std::sqrt(sum / count);
}

TEST_F(ReportSweeps, AtTheTruth_ResidualsAreTheRangesNoise) {
  const SensorResult sensor = lidar();
  const Json sweep = sweep_json({&sensor, &sweeps_}, &map_->map, 1'000'000);
  EXPECT_GT(sweep.at("points").get<std::size_t>(), 20'000U);
  EXPECT_EQ(counted(sweep.at("histogram")), sweep.at("points").get<std::size_t>());
  EXPECT_LT(inner_rms_mm(sweep), 1.1e3 * sweep.at("sigma_m").get<double>());
}

TEST_F(ReportSweeps, ElsewhereThanTheTruth_ResidualsShowIt) {
  SensorResult sensor = lidar();
  const double at_truth_mm = inner_rms_mm(sweep_json({&sensor, &sweeps_}, &map_->map, 1'000'000));
  sensor.T_room_sensor->t += Vec3(0.02, 0.02, 0.02);
  EXPECT_GT(inner_rms_mm(sweep_json({&sensor, &sweeps_}, &map_->map, 1'000'000)), 1.15 * at_truth_mm);
}

TEST_F(ReportSweeps, Thinned_KeepsAboutAsManyAsWantedButCountsAll) {
  const SensorResult sensor = lidar();
  const Json sweep = sweep_json({&sensor, &sweeps_}, &map_->map, 3000);
  EXPECT_LE(sweep.at("face").size(), 3600U);
  EXPECT_GT(sweep.at("face").size(), 2400U);
  EXPECT_EQ(sweep.at("points_mm").size(), 3 * sweep.at("face").size());
  EXPECT_EQ(counted(sweep.at("histogram")), sweep.at("points").get<std::size_t>());
}

TEST_F(ReportSweeps, WithoutAMap_HasPointsAndNoResiduals) {
  const SensorResult sensor = lidar();
  const Json sweep = sweep_json({&sensor, &sweeps_}, nullptr, 1000);
  EXPECT_FALSE(sweep.contains("histogram"));
  EXPECT_GT(sweep.at("face").size(), 0U);
  for (const Json& mm : sweep.at("residual_mm")) EXPECT_TRUE(mm.is_null());
}

TEST_F(ReportSweeps, ProjectedPoints_LieInTheImageAtTheirDistance) {
  const SensorResult sensor = lidar(), eye = camera();
  const Json points = projection_json(eye, {&sensor, &sweeps_}, 100'000);
  ASSERT_GT(points.size(), 300U);
  ASSERT_EQ(points.size() % 3, 0U);
  const camera::Intrinsics& k = eye.camera->intrinsics();
  for (std::size_t i = 0; i < points.size(); i += 3) {
    const int u = points[i], v = points[i + 1], cm = points[i + 2];
    EXPECT_TRUE(u >= 0 && u < k.width_px && v >= 0 && v < k.height_px);
    EXPECT_TRUE(cm > 10 && cm < 1000) << cm;
  }
}

}  // namespace
}  // namespace roomcal::tools
