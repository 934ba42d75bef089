#pragma once

#include <filesystem>

#include "runtime/math/types.h"

namespace roomcal::tools {

/// The mean of what an IMU at rest reported.
struct RestingImu {
  Vec3 held_up_mps2 = Vec3::Zero();
  Vec3 sigma_mps2 = Vec3::Zero();  ///< of the mean, per axis, samples taken as independent
  std::size_t samples = 0;
};

/// Reads CSV of `stamp_ns,ax_mps2,ay_mps2,az_mps2[,...]`, one line a sample, that header first.
/// @throws ToolError naming file and line for anything else, for fewer than ten samples, and for an IMU that did not
///         rest: the means of the recording's halves differ beyond chance and by more than 0.02 m/s^2.
RestingImu read_resting_imu(const std::filesystem::path& file);

}  // namespace roomcal::tools
