#pragma once

#include <cstddef>

#include <nlohmann/json.hpp>

#include "runtime/calib/outcome.h"

namespace roomcal::tools {

/// The JSON of `roomcal calibrate`: verdict, reasons, rig_frame, sensors, pairs, timing_ms, arena_peak_bytes.
/// Poses are 4x4 rows; covariance as CONVENTIONS.md says (translation m, rotation rad, right perturbation).
nlohmann::json to_json(const calib::Outcome& outcome, std::size_t arena_peak_bytes);

}  // namespace roomcal::tools
