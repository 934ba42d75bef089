#include "runtime/press/trouble.h"

#include <algorithm>

namespace roomcal::press {

Trouble trouble_of(const calib::Outcome& outcome) {
  if (may_write(outcome.verdict)) return Trouble::kNone;
  if (outcome.verdict == Verdict::kFailService) return Trouble::kService;
  const auto& cameras = outcome.cameras;
  // A camera whose picture was no good was not searched for rings at all.
  const auto blind = [](const calib::CameraOutcome& camera) {
    return !camera.has_image || (!camera.failure.empty() && camera.detections.empty());
  };
  if (std::any_of(cameras.begin(), cameras.end(), blind)) return Trouble::kImages;
  const auto lost = [](const auto& sensor) { return !sensor.failure.empty(); };
  if (std::any_of(cameras.begin(), cameras.end(), lost)) return Trouble::kPlace;
  if (std::any_of(outcome.lidars.begin(), outcome.lidars.end(), lost)) return Trouble::kLidar;
  return Trouble::kPlace;
}

}  // namespace roomcal::press
