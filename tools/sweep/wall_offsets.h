#pragma once

#include <cstddef>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "runtime/math/types.h"
#include "tools/sweep/load_sweeps.h"

namespace roomcal::tools {

/// A flat wall that a standing sensor sees: normal_lidar . p = distance_m.
struct SeenWall {
  Vec3 normal_lidar = Vec3::UnitX();
  double distance_m = 0;
  std::size_t points = 0;  ///< over all sweeps
};

/// Range offset of one beam against the walls, per sweep.
struct BeamOffset {
  std::size_t beam = 0, points = 0, sweeps = 0;
  double mean_mm = 0;    ///< measured minus wall, along the ray; the mean over the beams is 0 by definition
  double spread_mm = 0;  ///< standard deviation over the sweeps
  double noise_mm = 0;   ///< within a sweep, robust
};

struct WallOffsets {
  std::vector<SeenWall> walls;
  std::vector<BeamOffset> beams;  ///< those that see a wall in at least half of the sweeps
  double rms_mm = 0;              ///< of the beams' means
};

/// Fits the two or three largest planes to all sweeps of a sensor that stood still, together with an offset per beam.
///
/// Residual: range minus the wall's range along the ray, rays within 60 degrees of the normal. Offsets of all beams
/// alike cannot be told from a wall that stands farther: their mean is set to 0.
/// @throws ToolError if no plane holds a tenth of the points.
WallOffsets wall_offsets(const Recording& recording);

void print_wall_offsets(const WallOffsets& offsets);
nlohmann::json to_json(const WallOffsets& offsets);

}  // namespace roomcal::tools
