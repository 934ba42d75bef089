#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/fixed_text.h"
#include "runtime/base/fixed_vector.h"
#include "runtime/base/verdict.h"
#include "runtime/calib/device.h"
#include "runtime/marker/detector.h"
#include "runtime/pose/locate_camera.h"
#include "runtime/rig/camera_rig.h"
#include "runtime/scan/locate.h"

namespace roomcal::calib {

using roomcal::may_write;
using roomcal::to_string;
using roomcal::Verdict;

enum class Stage : uint8_t { kDetect, kLocate, kLocateLidars, kRefine, kJudge, kCount };
/// "detect", "locate", "locate_lidars", "refine", "judge".
const char* to_string(Stage stage);

/// What became of one camera. `located` guards the poses: without it they are not set, never identity by accident.
struct CameraOutcome {
  SensorName name;
  bool has_image = false;
  bool located = false;
  bool in_rig = false;    ///< located, and so is the reference: T_rig_cam is valid
  camera::Camera camera;  ///< as provisioned; refined if the device says so, solution.lens_of(view) how far
  SE3 T_rig_cam;          ///< after the joint solution
  SE3 T_room_cam;         ///< after the joint solution
  Mat66 cov_room_cam = Mat66::Zero();  ///< of T_room_cam as this camera alone tells
  Mat66 cov_rig_cam = Mat66::Zero();   ///< of T_rig_cam, right perturbation (m, rad); zero for the reference itself
  std::span<marker::Detection> detections;  ///< lives in the step arena; usable ones first
  bool detections_complete = true;  ///< false: the image held more than the detector's tables, some are left out
  std::size_t usable_detections = 0;
  std::span<pose::Correspondence> inliers;  ///< observation = number in `detections`; lives in the step arena
  double rms_px = 0;                        ///< of the inliers, after the joint solution
  double coverage = 0;                      ///< fraction of the 4 x 4 image cells that hold an inlier
  double log_likelihood_gap = 0;
  std::span<rig::RingObservation> rings;          ///< the inliers as the joint solution takes them, held-out ones last
  std::size_t kept_rings = 0;                     ///< of these, that are not held out
  std::size_t view = 0;                           ///< number in `solution`, if located
  Reason failure;                                 ///< why not located; empty otherwise
  Verdict failure_verdict = Verdict::kFailRetry;  ///< what `failure` asks for
};

/// What became of one LiDAR; `located` guards the poses as above.
struct LidarOutcome {
  SensorName name;
  std::size_t sweeps = 0;       ///< that came
  std::size_t used_sweeps = 0;  ///< of these, without a flag
  uint32_t flags = 0;           ///< of all that came, bits of lidar::SweepFlag
  bool located = false;
  bool in_rig = false;                            ///< located, and so is the reference: T_rig_lidar is valid
  bool had_prior = false;                         ///< from located cameras and the nominal mounting
  bool mount_took_part = false;                   ///< the mounting carries what the sweep does not see
  SE3 T_rig_lidar;                                ///< after the joint solution
  SE3 T_room_lidar;                               ///< after the joint solution
  Mat66 cov_rig_lidar = Mat66::Zero();            ///< of T_rig_lidar, right perturbation (m, rad)
  std::span<rig::PlanePull> pulls;                ///< of planes that the map is not sure of; lives in the step arena
  scan::Location location;                        ///< as the sweep alone tells: weak directions, beam offsets, shares
  std::size_t sensor = 0;                         ///< number in `solution`, if located
  Reason failure;                                 ///< why not located; empty otherwise
  Verdict failure_verdict = Verdict::kFailRetry;  ///< what `failure` asks for
};

/// The fifth of the markers that took no part in a second solution, against where that one puts them.
struct HeldOut {
  std::size_t markers = 0;   ///< observations that were predicted
  double median_sigmas = 0;  ///< typical miss in units of its predicted sigma; 1 if everything is as it claims
  SensorName worst_camera;   ///< whose own typical miss is the largest
};

/// One sensor of the installed record against this shot.
struct SensorChange {
  SensorName name;
  bool comparable = false;    ///< in the record and in this shot's rig
  Vec6 delta = Vec6::Zero();  ///< log(T_installed^-1 T_now), (m, rad), sensor frame
  Mat66 cov = Mat66::Zero();  ///< of delta: of both records
  double p_value = 1;         ///< that nothing has moved and chance alone gives as much
};

/// The installed record against this shot.
struct InstalledCheck {
  bool done = false;                               ///< the reference and another sensor could be compared
  FixedVector<SensorChange, kMaxSensors> sensors;  ///< of the record; empty: there is none
  double p_value = 1;                              ///< that nothing has moved, all sensors
  bool moved = false;
  SensorName moved_sensor;  ///< that explains the differences best; empty unless `moved`
};

inline constexpr std::size_t kMaxReasons = 32;

/// Everything that one press tells. Spans live in the step arena until its next reset.
struct Outcome {
  Verdict verdict = Verdict::kFailService;
  FixedVector<Reason, kMaxReasons> reasons;
  FixedVector<CameraOutcome, kMaxCameras> cameras;
  FixedVector<LidarOutcome, kMaxLidars> lidars;
  std::size_t reference = 0;           ///< number of the reference camera
  rig::RigSolution solution;           ///< all located sensors, by CameraOutcome::view and LidarOutcome::sensor
  std::span<rig::Landmark> landmarks;  ///< the map's markers, all of them, in its numbering; in the step arena
  std::span<Mat33> plane_cov;          ///< of the map's planes, by number; empty: all exact; in the step arena
  HeldOut held_out;
  InstalledCheck installed;
  std::array<int64_t, static_cast<std::size_t>(Stage::kCount)> stage_ns{};
};

/// A sensor of the joint solution, whatever it is.
struct LocatedSensor {
  SensorName name;
  std::size_t number = 0;  ///< in Outcome::solution
  bool in_rig = false;
  SE3 T_rig_sensor;
  Mat66 cov_rig_sensor = Mat66::Zero();
};
/// Cameras, then LiDARs, those that were located.
FixedVector<LocatedSensor, kMaxSensors> located_sensors(const Outcome& outcome);

}  // namespace roomcal::calib
