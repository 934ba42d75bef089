#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include "runtime/lidar/sweep.h"
#include "runtime/scan/sensor_model.h"

namespace roomcal::scan {

/// One usable point as a ray: where the beam went and how far it came.
struct Ray {
  Vec3 direction_lidar = Vec3::UnitX();
  double range_m = 0;
  uint16_t beam = 0;
  uint16_t reflectivity = 0;
};

/// The sweeps of one LiDAR, joined: taken while it stood still. Owns nothing.
struct SweepView {
  std::span<const lidar::Sweep> sweeps;

  std::size_t point_count() const {
    std::size_t count = 0;
    for (const lidar::Sweep& sweep : sweeps) count += sweep.points.size();
    return count;
  }
};

/// @return false for a point that cannot be used: not finite, nearer or farther than the sensor measures, or of a beam
/// that we have no place for. The range is taken from the point itself, so a sensor whose beams start off its origin by
/// centimetres is served too.
inline bool to_ray(const lidar::SweepPoint& point, const SensorModel& sensor, Ray& ray) {
  const Vec3 p_lidar(static_cast<double>(point.x_m), static_cast<double>(point.y_m), static_cast<double>(point.z_m));
  const double squared = p_lidar.squaredNorm();
  // NaN fails both comparisons.
  if (!(squared >= sensor.min_range_m * sensor.min_range_m && squared <= sensor.max_range_m * sensor.max_range_m)) {
    return false;
  }
  if (point.beam >= kMaxBeams) return false;
  ray.range_m = std::sqrt(squared);
  ray.direction_lidar = p_lidar / ray.range_m;
  ray.beam = point.beam;
  ray.reflectivity = point.reflectivity;
  return true;
}

/// The next stride that shares no factor with the beam counts of real sensors: one of 16 would see a single beam.
inline std::size_t fair_stride(std::size_t stride) {
  if (stride <= 1) return 1;
  std::size_t fair = stride | 1U;
  while (fair % 5 == 0) fair += 2;
  return fair;
}

/// Calls visit(ray) for every stride-th point (made fair) of the joined sweeps.
template <typename Visit>
void for_each_ray(const SweepView& view, const SensorModel& sensor, std::size_t stride, const Visit& visit) {
  const std::size_t step = fair_stride(stride);
  std::size_t next = 0;
  Ray ray;
  for (const lidar::Sweep& sweep : view.sweeps) {
    std::size_t i = next;
    for (; i < sweep.points.size(); i += step) {
      if (to_ray(sweep.points[i], sensor, ray)) visit(ray);
    }
    next = i - sweep.points.size();
  }
}

/// The stride that leaves about `wanted` points.
inline std::size_t stride_for(const SweepView& view, std::size_t wanted) {
  const std::size_t stride = view.point_count() / (wanted == 0 ? 1 : wanted);
  return stride == 0 ? 1 : stride;
}

}  // namespace roomcal::scan
