#include "tools/simulate/tls_scan.h"

#include <cmath>

#include "tools/simulate/random_stream.h"
#include "tools/simulate/raster.h"

namespace roomcal::tools {

namespace {

constexpr double kDivergence_rad = 0.001;

lidar::SweepPoint point_of(const Echo& echo, const Vec3& direction_lidar) {
  const Vec3 p_lidar = echo.range_m * direction_lidar;
  lidar::SweepPoint point;
  point.x_m = static_cast<float>(p_lidar.x());
  point.y_m = static_cast<float>(p_lidar.y());
  point.z_m = static_cast<float>(p_lidar.z());
  point.range_m = static_cast<float>(echo.range_m);
  point.reflectivity = static_cast<uint16_t>(std::lround(echo.reflectivity_percent));
  return point;
}

}  // namespace

Vec3 tls_direction_lidar(double servo_rad, double profile_rad) {
  const double level = std::cos(profile_rad);
  return {level * std::sin(servo_rad), -std::sin(profile_rad), level * std::cos(servo_rad)};
}

LoadedSweep scan_sphere(const EchoCaster& caster, const SE3& T_room_lidar, double step_rad, const RangeFlaws& flaws,
                        double offset_m, uint64_t seed) {
  const auto profiles = static_cast<int>(std::ceil(kPi / step_rad));
  const auto rays = static_cast<int>(std::ceil(2 * kPi / step_rad));
  std::vector<std::vector<lidar::SweepPoint>> scanned(static_cast<std::size_t>(profiles));
  parallel_for(profiles, [&](int i) {
    Random random = random_stream(seed, static_cast<uint64_t>(i));
    for (int k = 0; k < rays; ++k) {
      const Vec3 along = tls_direction_lidar(kPi * i / profiles, 2 * kPi * k / rays);
      const Pulse pulse{T_room_lidar.t, T_room_lidar.R * along, kDivergence_rad, offset_m};
      const Echo echo = caster.echo(pulse, flaws, random);
      if (echo.range_m > 0) scanned[static_cast<std::size_t>(i)].push_back(point_of(echo, along));
    }
  });
  LoadedSweep sweep;
  sweep.facts.beam_count = 1;
  for (const auto& profile : scanned) sweep.points.insert(sweep.points.end(), profile.begin(), profile.end());
  return sweep;
}

}  // namespace roomcal::tools
