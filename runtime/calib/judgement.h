#pragma once

#include <algorithm>
#include <cmath>

#include "runtime/base/reason.h"
#include "runtime/calib/outcome.h"
#include "runtime/calib/quality_gate.h"

namespace roomcal::calib {

/// Collects reasons; the verdict is the worst that any of them asks for.
class Judgement {
 public:
  explicit Judgement(Outcome& outcome) : outcome_(outcome) {
    outcome_.verdict = Verdict::kPass;
    outcome_.reasons.clear();
    for (const rig::Landmark& landmark : outcome.landmarks) map_variance_m2_ += landmark.cov_m2.trace() / 3;
    if (!outcome.landmarks.empty()) map_variance_m2_ /= static_cast<double>(outcome.landmarks.size());
  }
  /// Of the map's markers by its own word, 1-sigma per axis.
  double map_sigma_m() const { return std::sqrt(map_variance_m2_); }
  void add(Verdict verdict, const Reason& reason) {
    outcome_.verdict = std::max(outcome_.verdict, verdict);
    // A full list keeps the first reasons: they stand nearest to the cause. The verdict is not lost.
    static_cast<void>(outcome_.reasons.push_back(reason));
  }

 private:
  Outcome& outcome_;
  double map_variance_m2_ = 0;
};

/// 1-sigma of an extrinsic against the limits. A map that is not as good as these is to be made again.
void judge_covariance(const SensorName& name, const Mat66& cov_rig_sensor, const Limits& limits, Judgement& judgement);

/// An extrinsic against its drawing.
void judge_mounting(const SensorName& name, const NominalMounting& nominal, const SE3& T_rig_sensor,
                    const Limits& limits, Judgement& judgement);

}  // namespace roomcal::calib
