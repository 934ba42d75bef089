#pragma once

#include <string>

#include "runtime/math/se3.h"
#include "tools/common/random.h"
#include "tools/simulate/devices.h"

namespace roomcal::tools {

inline constexpr double kGravity_mps2 = 9.80665;  ///< the standard's

/// An IMU as it truly is. Axes: x forward, y left, z up, where its drawing has them.
struct TrueImu {
  std::string name = "imu0";
  SE3 T_room_imu;
  Vec3 accel_bias_mps2 = Vec3::Zero();
  Vec3 gyro_bias_radps = Vec3::Zero();
  double accel_sigma_mps2 = 0.02;  ///< of one sample, per axis
  double gyro_sigma_radps = 0.002;
};

/// The same on every device: right behind and below the reference camera, level with it.
MountingEdge imu_mounting();

/// Biases of a unit that its maker calibrated: 2 mg and 0.1 degree per second.
TrueImu draw_imu(const SE3& T_room_imu, Random& random);

/// What it reports at rest, two seconds at 200 Hz: CSV `stamp_ns,ax_mps2,ay_mps2,az_mps2,gx_radps,gy_radps,gz_radps`.
/// An accelerometer at rest shows what holds it up: +g along the room's z. The Earth's turn is left out.
std::string imu_csv(const TrueImu& imu, uint64_t seed);

}  // namespace roomcal::tools
