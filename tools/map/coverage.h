#pragma once

#include <cstdint>
#include <vector>

#include "runtime/camera/camera.h"
#include "runtime/math/se3.h"
#include "tools/map/map_data.h"

namespace roomcal::tools {

/// The device that stands in the room to see how well it would be located.
struct CoverageOptions {
  double focal_px = 800;  ///< of a 1280 x 1024 camera: 77 x 65 degrees, as on the paper's stereo pair
  int width_px = 1280, height_px = 1024;
  double sigma_px = 0.1;  ///< of a ring centre per axis
  double max_range_m = 8, max_slant_rad = deg_to_rad(70.0);
  double from_wall_m = 0.5;        ///< devices do not touch the walls
  std::size_t max_positions = 30;  ///< on a grid through the room, in two heights; each looks into six directions
  std::size_t enough_markers = 8;
  double enough_gap = 12;  ///< log-likelihood that the second-best pose has to stay behind (pose::LocateOptions)
  uint64_t seed = 1;
};

/// One look of the sample camera.
struct SampleView {
  SE3 T_room_cam;
  std::size_t markers = 0;  ///< in the image, facing it, not hidden by a plane of the map
  bool located = false;     ///< by the device's own locator, from ring centres alone, and within its gates
  double sigma_m = 0;       ///< of the position if located: root of the trace, map errors included
  double sigma_rad = 0;
  double gap = 0;  ///< how far the second-best pose stays behind, log-likelihood; no second: as of one inlier less
};

/// What a device would see from all over the room.
struct Coverage {
  std::vector<SampleView> views;
  double seen_share = 0;     ///< of the views: enough markers
  double located_share = 0;  ///< of the views: the locator finds the pose and no other
  double median_sigma_m = 0, median_sigma_rad = 0;
  double least_gap = 0, median_gap = 0;  ///< of the located views
};

/// Puts the sample camera on a grid through the room and locates it with the runtime's own code (pose/locate_camera.h):
/// what a device will live through, instead of a proxy for it.
/// @param data  with planes, outlines and triangles (complete_map()). z is up.
/// Cost: some milliseconds a view, 360 views at most. Deterministic.
Coverage measure_coverage(const MapData& data, const CoverageOptions& options = {});

}  // namespace roomcal::tools
