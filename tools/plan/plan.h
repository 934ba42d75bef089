#pragma once

#include <cstdint>
#include <vector>

#include "tools/map/coverage.h"
#include "tools/map/uniqueness.h"
#include "tools/plan/layout.h"

namespace roomcal::tools {

struct PlanOptions {
  SheetOutline outline;
  std::size_t sheets = 0;  ///< 0: as many as the target needs
  /// Of the sample looks that find their place. Looks at a wall from half a metre need the densest paper: a room of
  /// 3 x 4 x 2.7 m has 70 % with 100 sheets, 78 % with 200 and 88 % with the 300 that fit.
  double target_share = 0.85;
  double map_sigma_m = 0.001;    ///< expected of the bake, per axis; enters the predicted sigma
  double least_unique_m = 0.02;  ///< places more alike are pulled apart
  uint64_t seed = 1;
  CoverageOptions coverage;  ///< the camera that will stand in the room
};

/// A layout and what may be expected of it.
struct Plan {
  std::vector<Wall> walls;
  std::vector<PlannedSheet> sheets;
  MapData data;  ///< complete, as `map import` would make it of the layout
  Coverage coverage;
  std::optional<Uniqueness> uniqueness;  ///< absent below 18 sheets
  bool full = false;                     ///< no further sheet fits
  bool met = false;                      ///< coverage reaches the target
};

/// Fewest sheets (of a series that grows by an eighth) whose coverage, measured by the device's own locator
/// (tools/map/coverage.h), reaches the target; then places that look alike are pulled apart.
/// @throws ToolError if not one sheet fits on the walls, or not as many as were asked for.
/// Cost: some seconds for a room of 50 m^2. Deterministic for a seed.
Plan make_plan(const std::vector<Wall>& walls, const PlanOptions& options);

}  // namespace roomcal::tools
