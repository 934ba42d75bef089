#include "tools/evaluate/pair_tally.h"

#include <cmath>

#include <Eigen/Cholesky>

namespace roomcal::tools {

namespace {

double root_mean(double sum, std::size_t count) { return count == 0 ? 0 : std::sqrt(sum / static_cast<double>(count)); }

struct Sensor {
  calib::LocatedSensor located;
  SE3 T_rig_sensor;  ///< truth
  bool lidar = false;
};

std::vector<Sensor> located(const calib::Outcome& outcome, const TrustDevice& device) {
  std::vector<Sensor> sensors;
  for (const calib::LocatedSensor& sensor : calib::located_sensors(outcome))
    for (std::size_t i = 0; i < device.sensors(); ++i)
      if (device.name(i) == sensor.name.view())
        sensors.push_back({sensor, device.T_rig_sensor[i], i >= device.device.cameras.size()});
  return sensors;
}

void add_pair(const calib::Outcome& outcome, const Sensor& a, const Sensor& b, PairTallies& tallies) {
  const PairKind kind = !b.lidar ? PairKind::kCameraCamera : a.lidar ? PairKind::kLidarLidar : PairKind::kCameraLidar;
  PairTally& pair = tallies[static_cast<std::size_t>(kind)];
  const rig::RelativePose estimate = rig::relative_pose(outcome.solution, a.located.number, b.located.number);
  const Vec6 error = se3_log(estimate.T_a_b.inverse() * (a.T_rig_sensor.inverse() * b.T_rig_sensor));
  pair.nees.push_back(error.dot(estimate.cov.ldlt().solve(error)));
  pair.squares_m2 += error.head<3>().squaredNorm();
  pair.squares_rad2 += error.tail<3>().squaredNorm();
  pair.variances_m2 += estimate.cov.topLeftCorner<3, 3>().trace();
  pair.variances_rad2 += estimate.cov.bottomRightCorner<3, 3>().trace();
}

}  // namespace

const char* to_string(PairKind kind) {
  switch (kind) {
    case PairKind::kCameraCamera:
      return "camera-camera";
    case PairKind::kCameraLidar:
      return "camera-LiDAR";
    case PairKind::kLidarLidar:
      return "LiDAR-LiDAR";
  }
  return "";
}

double PairTally::rms_m() const { return root_mean(squares_m2, nees.size()); }
double PairTally::rms_rad() const { return root_mean(squares_rad2, nees.size()); }
double PairTally::sigma_m() const { return root_mean(variances_m2, nees.size()); }
double PairTally::sigma_rad() const { return root_mean(variances_rad2, nees.size()); }

void add_pairs(const calib::Outcome& outcome, const TrustDevice& device, PairTallies& tallies) {
  const std::vector<Sensor> sensors = located(outcome, device);
  for (std::size_t a = 0; a < sensors.size(); ++a)
    for (std::size_t b = a + 1; b < sensors.size(); ++b) add_pair(outcome, sensors[a], sensors[b], tallies);
}

}  // namespace roomcal::tools
