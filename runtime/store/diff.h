#pragma once

#include "runtime/base/fixed_vector.h"
#include "runtime/store/record.h"

namespace roomcal::store {

/// How one sensor moved from record `a` to record `b`.
struct SensorDiff {
  SensorName name;
  bool in_a = false;
  bool in_b = false;
  Vec6 xi = Vec6::Zero();  ///< log(T_a^-1 T_b): (m, rad) in the sensor's own frame; only if in both
  double distance_m = 0;
  double angle_rad = 0;
  /// xi' (Sigma_a + Sigma_b)^-1 xi, chi-square with 6 degrees of freedom if nothing moved and the errors are
  /// independent.
  double chi2 = 0;
  bool has_chi2 = false;  ///< false for the reference, which has no covariance
};

struct RecordDiff {
  bool same_reference = false;  ///< false: the poses are in different rig frames and are not compared
  bool same_map = false;
  FixedVector<SensorDiff, 2 * kMaxSensors> sensors;  ///< in the order of a, then those only in b
};

/// Compares two valid records. Cost: one 6x6 factorization a sensor; no allocation.
RecordDiff diff(const Record& a, const Record& b);

}  // namespace roomcal::store
