#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "runtime/base/fixed_text.h"
#include "runtime/base/fixed_vector.h"
#include "runtime/base/status.h"
#include "runtime/base/verdict.h"
#include "runtime/camera/intrinsics.h"
#include "runtime/math/se3.h"
#include "runtime/store/format.h"

namespace roomcal::store {

enum class SensorKind : uint8_t { kCamera, kLidar };

/// What brought a record into the store.
enum class Action : uint8_t {
  kProvisioned,      ///< the factory record, written once
  kCalibrated,       ///< a press of the button
  kUndone,           ///< an earlier record, written again
  kFactoryRestored,  ///< the factory record, written again
};
/// "provisioned", "calibrated", "undone", "factory-restored".
const char* to_string(Action action);

using Serial = FixedText<31>;
using LongId = FixedText<63>;

/// How well the room was seen. `rms` is in pixels for a camera, in metres for a LiDAR.
struct Evidence {
  uint32_t detections = 0;
  uint32_t inliers = 0;
  double rms = 0;
  double coverage = 0;
  double log_likelihood_gap = 0;
};

/// One sensor of a record. There is none without a valid pose: a sensor that was not located is not in the record.
struct SensorRecord {
  SensorName name;
  SensorKind kind = SensorKind::kCamera;
  SensorName model;  ///< of a LiDAR: "vlp16", ...
  Serial serial;
  SE3 T_rig_sensor;
  Mat66 cov_rig_sensor =
      Mat66::Zero();              ///< of T_rig_sensor, right perturbation (m, rad); zero for the reference itself
  camera::Intrinsics intrinsics;  ///< of a camera
  Evidence evidence;
};

/// The factory record's content; generations of the store's own records begin at 1.
inline constexpr uint64_t kFactoryContent = 0;
inline constexpr uint64_t kNothingBefore = std::numeric_limits<uint64_t>::max();

/// A calibration as it is stored: plain, self-contained, enough to use it, to judge it and to export it.
struct Record {
  uint64_t generation = 0;  ///< counts writes; the highest valid one is in force
  /// Generation at which this content was measured: an undo has a new generation and an old content.
  uint64_t content_generation = 0;
  uint64_t previous_content = kNothingBefore;  ///< content in force before this one: where undo goes
  Action action = Action::kCalibrated;
  Verdict verdict = Verdict::kFailService;
  FixedVector<Reason, kMaxReasons> reasons;
  LongId map_id;
  uint32_t map_hash = 0;  ///< CRC-32C of the map's content, as `roomcal map info` prints it
  LongId firmware_id;
  Serial device_serial;
  int64_t measured_unix_s = 0;                                      ///< 0: the device had no clock
  int64_t written_unix_s = 0;                                       ///< 0: the device had no clock
  double temperature_c = std::numeric_limits<double>::quiet_NaN();  ///< NaN: not measured
  Serial trigger;                                                   ///< what made the cameras expose; empty: not told
  double chi2 = 0;                                                  ///< of the joint solution
  uint32_t degrees_of_freedom = 0;
  std::size_t reference = 0;  ///< number of the sensor whose frame is the rig's
  FixedVector<SensorRecord, kMaxSensors> sensors;

  /// @return nullptr if there is none of that name.
  const SensorRecord* find(std::string_view name) const;
};

/// Whether a record may be stored or used: at least one sensor, names unique and printable, rotations orthonormal,
/// covariances finite and positive semi-definite, intrinsics finite, the reference at the identity with zero covariance
/// and nobody else there.
/// @return kCorrupt naming what is wrong.
/// Cost: an eigenvalue decomposition of 6x6 a sensor; no allocation.
Status check_record(const Record& record);

}  // namespace roomcal::store
