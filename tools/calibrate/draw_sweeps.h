#pragma once

#include <filesystem>

#include "runtime/calib/device.h"
#include "runtime/calib/outcome.h"
#include "runtime/map/room_map.h"
#include "tools/calibrate/shot_folder.h"

namespace roomcal::tools {

/// Pictures that show an extrinsic at a glance:
/// `<camera>_<lidar>.png`, the first sweep in the image, coloured by distance (red 0.5 m to blue 6 m);
/// `sweeps_registered.png`, all located LiDARs' first sweeps in the room, each in its colour, from above and from the
/// side, over the map's markers.
void draw_sweeps(const calib::Outcome& outcome, const map::RoomMap& map, const ShotFolder& shot,
                 const std::filesystem::path& folder);

}  // namespace roomcal::tools
