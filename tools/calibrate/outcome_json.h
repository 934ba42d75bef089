#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "runtime/calib/device.h"
#include "runtime/calib/outcome.h"
#include "runtime/map/room_map.h"

namespace roomcal::tools {

/// Where a result comes from.
struct ResultContext {
  std::string device;         ///< name; may be empty
  std::string device_serial;  ///< may be empty
  std::string firmware;       ///< the program that computed it
  int64_t measured_unix_s = 0;
  std::vector<std::string> lidar_files;  ///< in the shot's folder, one per LiDAR; empty where there was none
  std::size_t arena_peak_bytes = 0;
};

/// The JSON of `roomcal calibrate`: verdict, reasons, rig_frame, map, device, firmware, measured_unix_s, sensors,
/// pairs, joint_fit, held_out, installed, timing_ms, arena_peak_bytes. Poses are 4x4 rows; covariance as CONVENTIONS.md
/// says (translation m, rotation rad, right perturbation).
nlohmann::json to_json(const calib::Outcome& outcome, const calib::Device& device, const map::RoomMap& map,
                       const ResultContext& context);

}  // namespace roomcal::tools
