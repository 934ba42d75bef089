#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

#include "tools/report/result_file.h"

namespace roomcal::tools {

/// T_rig_sensor of a result beside another source's, sensor by sensor: {name: {comparable, delta, covariance, p_value}}
/// as in the result's own `installed`. The reference is left out.
///
/// Against an installed calibration: delta = log(T_installed^-1 T_now), covariance the sum of both; an installed
/// calibration in another rig frame is carried over to this one's.
nlohmann::json against_installed(const ResultFile& now, const ResultFile& installed);

/// Against the truth of a simulated shot: delta = log(T_now^-1 T_true), covariance the result's.
/// @param truth_file  truth.json of the shot.
/// @throws ToolError naming the file if it is no truth, or lacks a sensor of the result.
nlohmann::json against_truth(const ResultFile& now, const std::filesystem::path& truth_file);

}  // namespace roomcal::tools
