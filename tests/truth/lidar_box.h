#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "runtime/lidar/calibration.h"
#include "tools/simulate/vlp16_packets.h"

namespace roomcal::truth {

/// Direction of a VLP-16's laser: x right, y forward, z up, azimuth from +y to +x.
inline Vec3 vlp16_ray_lidar(double azimuth_rad, double elevation_rad) {
  return {std::cos(elevation_rad) * std::sin(azimuth_rad), std::cos(elevation_rad) * std::cos(azimuth_rad),
          std::sin(elevation_rad)};
}

/// Range along a ray from the origin to the inside of a box, metres.
inline double box_range_m(const Vec3& ray, const Vec3& low, const Vec3& high) {
  double range = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(ray[axis]) > 1e-12) range = std::min(range, (ray[axis] > 0 ? high[axis] : low[axis]) / ray[axis]);
  return range;
}

/// What a VLP-16 sees from inside a box, firing by firing. @param bias_m  of each laser
inline std::vector<tools::Vlp16Return> box_returns(const tools::Vlp16Stream& stream, std::size_t firings,
                                                   const Vec3& low, const Vec3& high,
                                                   const std::vector<double>& bias_m = {}) {
  const lidar::Calibration calibration = lidar::built_in_calibration(lidar::Model::kVlp16).value();
  std::vector<tools::Vlp16Return> returns;
  for (std::size_t firing = 0; firing < firings; ++firing) {
    for (std::size_t laser = 0; laser < tools::kVlp16Lasers; ++laser) {
      const Vec3 ray = vlp16_ray_lidar(stream.azimuth_rad(firing, laser), calibration.beams[laser].elevation_rad);
      const double bias = bias_m.empty() ? 0 : bias_m[laser];
      returns.push_back({box_range_m(ray, low, high) + bias, static_cast<uint8_t>(10 + laser), 0, 0});
    }
  }
  return returns;
}

}  // namespace roomcal::truth
