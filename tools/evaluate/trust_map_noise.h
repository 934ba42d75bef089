#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/evaluate/trust_shot.h"

namespace roomcal::tools {

enum class PairKind : uint8_t { kCameraCamera, kCameraLidar, kLidarLidar };
inline constexpr std::array kPairKinds = {PairKind::kCameraCamera, PairKind::kCameraLidar, PairKind::kLidarLidar};
const char* to_string(PairKind kind);

/// Pairs of one kind over many shots: what they are off by, and what they say.
struct PairTally {
  std::vector<double> nees;  ///< of each pair of each shot
  double squares_m2 = 0, squares_rad2 = 0;
  double variances_m2 = 0, variances_rad2 = 0;  ///< predicted

  double rms_m() const;
  double rms_rad() const;
  double sigma_m() const;
  double sigma_rad() const;
};

/// Shots in rooms of which the map is noisy and says so: markers off by sigma_m per axis, planes fitted to them.
struct MapNoiseTally {
  double sigma_m = 0;
  int shots = 0;
  int passed = 0;  ///< that may be written
  std::array<PairTally, kPairKinds.size()> pairs;
};

/// One shot with a map of its own.
void run_map_noise_trial(const TrustRoom& room, uint64_t seed, MapNoiseTally& tally);

}  // namespace roomcal::tools
