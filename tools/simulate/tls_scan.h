#pragma once

#include <vector>

#include "runtime/math/se3.h"
#include "tools/simulate/echo.h"
#include "tools/sweep/load_sweeps.h"

namespace roomcal::tools {

/// A terrestrial scanner: a profiler that turns in an upright plane, and a servo that turns this plane half around.
///
/// LiDAR frame as its cameras': x right, y down, z forward. The servo's axis is y. The profiler's ray at servo angle a
/// and profile angle b is  cos(b) (sin(a) x + cos(a) z) + sin(b) (-y).
Vec3 tls_direction_lidar(double servo_rad, double profile_rad);

/// The whole sphere. @param step_rad  of both angles; 0.5 degree makes 259,200 points, 0.13 degree 3.8 million
/// @param offset_m  constant error of all ranges
LoadedSweep scan_sphere(const EchoCaster& caster, const SE3& T_room_lidar, double step_rad, const RangeFlaws& flaws,
                        double offset_m, uint64_t seed);

}  // namespace roomcal::tools
