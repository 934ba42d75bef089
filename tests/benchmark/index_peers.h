#pragma once

#include "tools/evaluate/lidar_trial.h"

namespace roomcal::tools {

/// Prints time and memory of our index of the dense map and of nanoflann's, on the same points and queries.
/// @return whether both give the same distances.
bool compare_indices(const LidarRoom& room);

}  // namespace roomcal::tools
