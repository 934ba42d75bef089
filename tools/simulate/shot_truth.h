#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "tools/simulate/record_lidar.h"
#include "tools/simulate/shot.h"

namespace roomcal::tools {

/// What there is to say about one shot beside its stand.
struct ShotFacts {
  std::vector<Picture> pictures;           ///< of every camera; the images themselves are not looked at
  std::vector<LidarRecording> recordings;  ///< of every LiDAR; likewise
};

/// The device's mounting by its drawing, as `import kalibr --nominal` reads it.
nlohmann::json nominal_json(const Stand& stand, const ShotOptions& options);

/// All that is true: poses, extrinsics of every pair, how mountings were drawn, what every picture and sweep shows.
nlohmann::json truth_json(const Scene& scene, const Stand& stand, const ShotFacts& facts, const ShotOptions& options);

}  // namespace roomcal::tools
