#pragma once

#include <cstddef>
#include <span>

#include "runtime/lidar/sweep.h"

namespace roomcal::scan {

/// The sweeps of one LiDAR, joined: taken while it stood still. Owns nothing.
struct SweepView {
  std::span<const lidar::Sweep> sweeps;

  std::size_t point_count() const {
    std::size_t count = 0;
    for (const lidar::Sweep& sweep : sweeps) count += sweep.points.size();
    return count;
  }
};

/// The next stride that shares no factor with the beam counts of real sensors: one of 16 would see a single beam.
inline std::size_t fair_stride(std::size_t stride) {
  if (stride <= 1) return 1;
  std::size_t fair = stride | 1U;
  while (fair % 5 == 0) fair += 2;
  return fair;
}

/// The stride that leaves about `wanted` points.
inline std::size_t stride_for(const SweepView& view, std::size_t wanted) {
  const std::size_t stride = view.point_count() / (wanted == 0 ? 1 : wanted);
  return stride == 0 ? 1 : stride;
}

}  // namespace roomcal::scan
