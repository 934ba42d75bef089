#pragma once

#include <string>
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

/// Echoes over the whole sphere, profile by profile. Within one the servo stands still.
struct SphereScan {
  int profiles = 0, rays = 0;  ///< over half a turn of the servo; over a turn of the profiler
  std::vector<Echo> echoes;

  double servo_rad(int profile) const { return kPi * profile / profiles; }
  double profile_rad(int ray) const { return 2 * kPi * ray / rays; }
  const Echo& at(int profile, int ray) const { return echoes[static_cast<std::size_t>(profile * rays + ray)]; }
};

/// @param step_rad  of both angles at most; the scanner's steps are whole 1e-4 degrees that fill a turn. 0.5 degree
/// makes
///                  259,200 points, 0.13 (then 0.125) degree 4.1 million
/// @param offset_m  constant error of all ranges
SphereScan scan_sphere(const EchoCaster& caster, const SE3& T_room_lidar, double step_rad, const RangeFlaws& flaws,
                       double offset_m, uint64_t seed);

/// The scan as a cloud in the LiDAR's frame.
LoadedSweep cloud_of(const SphereScan& scan);

/// The scan as the profiler tells it: packets of a Pepperl+Fuchs R2000 (type C, ranges in millimetres), one turn a
/// profile, 50 turns a second. Profiler's x at profile angle 0, y at 90 degrees.
std::vector<std::byte> profiles_pcap(const SphereScan& scan);

/// Where the servo stood: CSV `stamp_ns,angle_rad`, a line a profile, stamps on the packets' clock.
std::string servo_csv(const SphereScan& scan);

}  // namespace roomcal::tools
