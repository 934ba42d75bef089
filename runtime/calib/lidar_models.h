#pragma once

#include <string_view>

#include "runtime/lidar/model.h"
#include "runtime/scan/sensor_model.h"

namespace roomcal::calib {

/// What a model's data sheet says about its ranges, by the name in device.yaml; nullptr if it is not known.
///
/// Sigmas are starting points: a sweep that scatters more is weighed by what it shows (scan::Location::sigma_m), and
/// beam offsets are estimated along. One table, in lidar_models.cpp, with the sources.
const scan::SensorModel* ranges_of(std::string_view model);

/// The model whose packets a device of this name sends: a terrestrial scanner ("tls") is an R2000 on a turntable, "os0"
/// is an Ouster. @return nullptr if the decoders do not know it.
const lidar::ModelInfo* packets_of(std::string_view model);

}  // namespace roomcal::calib
