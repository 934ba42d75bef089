#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "tools/evaluate/trust_shot.h"

namespace roomcal::tools {

/// An error that is larger than this, and than so many of the sigmas that its covariance predicts along it, makes an
/// extrinsic wrong.
inline constexpr double kWrongSigmas = 5, kWrong_m = 0.003, kWrong_deg = 0.1;

/// Extrinsics of one kind of sensor against the truth.
struct ExtrinsicErrors {
  double square_m2 = 0, square_deg2 = 0;  ///< summed up
  double worst_m = 0, worst_deg = 0;
  double nees = 0;  ///< summed up; 6 each is honest
  int count = 0;

  void add(const SE3& T_hat, const SE3& T_true, const Mat66& cov);
  void add(const ExtrinsicErrors& other);
};

/// What became of one shot.
struct ShotResult {
  bool accepted = false;            ///< would be written
  bool wrong = false;               ///< accepted, and an extrinsic in it is wrong
  double worst_sigmas = 0;          ///< of any error that is larger than kWrong_m or kWrong_deg
  std::set<std::string> reasons;    ///< without names and numbers
  ExtrinsicErrors cameras, lidars;  ///< accepted only
};
ShotResult result_of(const calib::Outcome& outcome, const TrustDevice& device);

/// A reason without the sensor's name, its numbers and its remedy.
std::string class_of(const std::string& reason);

/// Many shots of one kind.
struct ShotTally {
  int shots = 0, accepted = 0, wrong = 0;
  double worst_sigmas = 0;
  ExtrinsicErrors cameras, lidars;
  std::map<std::string, int> refused_with;  ///< reason -> refused shots that gave it
  std::set<std::string> accepted_with;      ///< reasons that are advice, then

  void add(const ShotResult& result);
  /// Reasons that refused, most frequent first.
  std::vector<std::pair<std::string, int>> refusals() const;
};

}  // namespace roomcal::tools
