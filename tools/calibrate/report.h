#pragma once

#include <filesystem>

#include "runtime/calib/outcome.h"
#include "tools/calibrate/shot_folder.h"

namespace roomcal::tools {

/// Verdict, reasons, one line per camera, times; for a person at a terminal.
void print_outcome(const calib::Outcome& outcome, std::size_t arena_peak_bytes);

/// T_rig_sensor beside the truth: errors and predicted sigmas, one line per camera.
/// @param truth_file  truth.json of a simulated shot (T_room_sensor.<name>.T).
/// @throws ToolError if the file is not such a truth or lacks a sensor.
void print_against_truth(const calib::Outcome& outcome, const std::filesystem::path& truth_file);

/// One picture per camera: detections, map markers projected with the solved pose, residuals enlarged.
void draw_outcome(const calib::Outcome& outcome, const map::RoomMap& map, const ShotFolder& shot,
                  const std::filesystem::path& folder);

}  // namespace roomcal::tools
