#pragma once

#include <cstddef>
#include <vector>

#include <nlohmann/json.hpp>

#include "runtime/map/room_map.h"
#include "tools/report/result_file.h"
#include "tools/sweep/load_sweeps.h"

namespace roomcal::tools {

/// Points of all sweeps that a page draws in the room, and in its images.
inline constexpr std::size_t kRoomPoints = 40'000;
inline constexpr std::size_t kImagePoints = 60'000;

/// A located LiDAR with its sweeps.
struct LocatedSweeps {
  const SensorResult* sensor = nullptr;  ///< with T_room_sensor and a LiDAR that calib::ranges_of() knows
  const std::vector<LoadedSweep>* sweeps = nullptr;
};

/// The sweeps in the room, thinned: {sigma_m, normals, points, points_mm [x y z ...], residual_mm [...], face [...],
/// histogram {low_mm, step_mm, counts, outside}}. A residual is what the beam measured, less its offset, less the way
/// to the map's first surface; null where it meets none, and `face` is then -1. `normals` are of the faces, in the
/// room; without a map there are no residuals. The histogram counts all points, not only those that are drawn.
/// @param wanted  about so many points are kept.
nlohmann::ordered_json sweep_json(const LocatedSweeps& located, const map::RoomMap* map, std::size_t wanted);

/// What of the first sweep a camera sees: [u v cm ...], pixels of the original image and the distance from the camera.
/// @param camera  with T_room_sensor.
/// @param wanted  about so many points are kept.
nlohmann::ordered_json projection_json(const SensorResult& camera, const LocatedSweeps& located, std::size_t wanted);

}  // namespace roomcal::tools
