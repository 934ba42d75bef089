#pragma once

#include <array>
#include <cstdint>
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
using PairTallies = std::array<PairTally, kPairKinds.size()>;

/// All pairs of located sensors against the truth.
void add_pairs(const calib::Outcome& outcome, const TrustDevice& device, PairTallies& tallies);

}  // namespace roomcal::tools
