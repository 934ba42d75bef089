#include "tools/simulate/imu.h"

#include <fmt/core.h>

#include "tools/simulate/lidar_unit.h"
#include "tools/simulate/random_stream.h"

namespace roomcal::tools {

namespace {

constexpr double kAccelBias_mps2 = 0.002 * kGravity_mps2;
constexpr double kGyroBias_radps = deg_to_rad(0.1);
constexpr int kSamples = 400;
constexpr int64_t kInterval_ns = 5'000'000;

Vec3 normals(double sigma, Random& random) { return sigma * Vec3(random.normal(), random.normal(), random.normal()); }

}  // namespace

MountingEdge imu_mounting() { return {"imu0", "cam0", {-90, 0, -90}, {0.02, 0, 0.03}}; }

TrueImu draw_imu(const SE3& T_room_imu, Random& random) {
  TrueImu imu;
  imu.T_room_imu = T_room_imu;
  imu.accel_bias_mps2 = normals(kAccelBias_mps2, random);
  imu.gyro_bias_radps = normals(kGyroBias_radps, random);
  return imu;
}

std::string imu_csv(const TrueImu& imu, uint64_t seed) {
  Random random = random_stream(seed, 200);
  const Vec3 held_up_imu = imu.T_room_imu.R.transpose() * Vec3(0, 0, kGravity_mps2);
  std::string csv = "stamp_ns,ax_mps2,ay_mps2,az_mps2,gx_radps,gy_radps,gz_radps\n";
  for (int i = 0; i < kSamples; ++i) {
    const Vec3 a = held_up_imu + imu.accel_bias_mps2 + normals(imu.accel_sigma_mps2, random);
    const Vec3 g = imu.gyro_bias_radps + normals(imu.gyro_sigma_radps, random);
    csv += fmt::format("{},{:.6f},{:.6f},{:.6f},{:.7f},{:.7f},{:.7f}\n", kRecordingStart_ns + i * kInterval_ns, a.x(),
                       a.y(), a.z(), g.x(), g.y(), g.z());
  }
  return csv;
}

}  // namespace roomcal::tools
