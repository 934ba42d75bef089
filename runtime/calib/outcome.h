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

namespace roomcal::calib {

using roomcal::may_write;
using roomcal::to_string;
using roomcal::Verdict;

enum class Stage : uint8_t { kDetect, kLocate, kRefine, kJudge, kCount };
/// "detect", "locate", "refine", "judge".
const char* to_string(Stage stage);

/// What became of one camera. `located` guards the poses: without it they are not set, never identity by accident.
struct CameraOutcome {
  SensorName name;
  bool has_image = false;
  bool located = false;
  bool in_rig = false;                ///< located, and so is the reference: T_rig_cam is valid
  SE3 T_rig_cam;                      ///< after the joint solution
  SE3 T_room_cam;                     ///< after the joint solution
  Mat66 cov_rig_cam = Mat66::Zero();  ///< of T_rig_cam, right perturbation (m, rad); zero for the reference itself
  std::span<marker::Detection> detections;  ///< lives in the step arena; usable ones first
  std::size_t usable_detections = 0;
  std::span<pose::Correspondence> inliers;  ///< observation = number in `detections`; lives in the step arena
  double rms_px = 0;                        ///< of the inliers, after the joint solution
  double coverage = 0;                      ///< fraction of the 4 x 4 image cells that hold an inlier
  double log_likelihood_gap = 0;
  std::size_t view = 0;  ///< number in `solution`, if located
  Reason failure;        ///< why not located; empty otherwise
};

inline constexpr std::size_t kMaxReasons = 32;

/// Everything that one press tells. Spans live in the step arena until its next reset.
struct Outcome {
  Verdict verdict = Verdict::kFailService;
  FixedVector<Reason, kMaxReasons> reasons;
  FixedVector<CameraOutcome, kMaxCameras> cameras;
  std::size_t reference = 0;
  rig::RigSolution solution;  ///< all located cameras, numbered by CameraOutcome::view
  std::array<int64_t, static_cast<std::size_t>(Stage::kCount)> stage_ns{};
};

}  // namespace roomcal::calib
