#pragma once

#include <cstddef>

#include <nlohmann/json.hpp>

#include "runtime/calib/device.h"
#include "runtime/calib/outcome.h"
#include "runtime/map/room_map.h"

namespace roomcal::tools {

/// The JSON of `roomcal calibrate`: verdict, reasons, rig_frame, map, sensors, pairs, timing_ms, arena_peak_bytes.
/// Poses are 4x4 rows; covariance as CONVENTIONS.md says (translation m, rotation rad, right perturbation).
nlohmann::json to_json(const calib::Outcome& outcome, const calib::Device& device, const map::RoomMap& map,
                       std::size_t arena_peak_bytes);

}  // namespace roomcal::tools
