#pragma once

#include <string_view>

#include "runtime/scan/sensor_model.h"

namespace roomcal::calib {

/// What a model's data sheet says about its ranges, by the name in device.yaml; nullptr if it is not known.
///
/// Sigmas are starting points: a sweep that scatters more is weighed by what it shows (scan::Location::sigma_m), and
/// beam offsets are estimated along. One table, in lidar_models.cpp, with the sources.
const scan::SensorModel* ranges_of(std::string_view model);

}  // namespace roomcal::calib
