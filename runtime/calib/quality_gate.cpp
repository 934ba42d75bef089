#include "runtime/calib/quality_gate.h"

#include <algorithm>
#include <cmath>

#include "runtime/calib/judgement.h"
#include "runtime/calib/lidar_gate.h"

namespace roomcal::calib {

namespace {

void judge_location(const CameraOutcome& camera, const Limits& limits, Judgement& judgement) {
  const Name name(camera.name);
  if (!camera.detections_complete)
    judgement.add(
        Verdict::kPassAdvise,
        make_reason("%.*s: more ring-like shapes than the %zu that are kept, some are left out: mend the noise "
                    "or cover the pattern",
                    name.length, name.text, kMaxDetections));
  if (!camera.located) return judgement.add(camera.failure_verdict, camera.failure);
  const std::size_t inliers = camera.inliers.size();
  const std::size_t usable = std::max<std::size_t>(1, camera.usable_detections);
  const double outlier_share = 1.0 - static_cast<double>(inliers) / static_cast<double>(usable);
  if (outlier_share > limits.max_outlier_share)
    judgement.add(Verdict::kFailService,
                  make_reason("%.*s: %.0f %% of its %zu markers are not where the map has them (limit %.0f %%): "
                              "is this the map of this room, and have markers moved?",
                              name.length, name.text, 100 * outlier_share, usable, 100 * limits.max_outlier_share));
  if (inliers < limits.advise_inliers)
    judgement.add(Verdict::kPassAdvise,
                  make_reason("%.*s: only %zu markers carry its pose: turn the device or add markers", name.length,
                              name.text, inliers));
  if (camera.coverage < limits.advise_coverage)
    judgement.add(Verdict::kPassAdvise,
                  make_reason("%.*s: markers fill only %.0f %% of its image: turn the device or add markers",
                              name.length, name.text, 100 * camera.coverage));
}

/// Refined parameters against the given ones.
void judge_intrinsics(const CameraOutcome& camera, const rig::RigSolution& solution, const Limits& limits,
                      Judgement& judgement) {
  const rig::RefinedLens* lens = camera.located ? solution.lens_of(camera.view) : nullptr;
  if (lens == nullptr) return;
  const camera::Parameters refined = camera::parameters_of(lens->camera.intrinsics());
  for (Eigen::Index k = 0; k < camera::kIntrinsicsCount; ++k) {
    const double off = std::abs(refined[k] - lens->prior[k]);
    if (off <= limits.max_intrinsics_sigmas * lens->prior_sigma[k]) continue;
    const Name name(camera.name);
    judgement.add(Verdict::kFailService,
                  make_reason("%.*s: its %s comes out %.1f sigma from what the device says: calibrate this lens again; "
                              "or is it another camera's?",
                              name.length, name.text, camera::kParameterNames[static_cast<std::size_t>(k)],
                              off / lens->prior_sigma[k]));
    return;  // one is enough to have it looked at
  }
}

/// The camera whose rings fit worst, for whom to look at first.
SensorName worst_fitting(const Outcome& outcome) {
  SensorName worst;
  double most = -1;
  for (const CameraOutcome& camera : outcome.cameras) {
    if (!camera.located || camera.rings.empty()) continue;
    const double ratio = outcome.solution.chi2_camera[camera.view] / static_cast<double>(camera.rings.size());
    if (ratio <= most) continue;
    most = ratio;
    worst = camera.name;
  }
  return worst;
}

void judge_fit(const Outcome& outcome, const Limits& limits, Judgement& judgement) {
  if (outcome.solution.degrees_of_freedom <= 0) return;
  const double ratio = outcome.solution.chi2 / outcome.solution.degrees_of_freedom;
  if (ratio <= limits.advise_chi2_per_dof) return;
  const SensorName worst = worst_fitting(outcome);
  const Name name(worst);
  if (!(ratio <= limits.max_chi2_per_dof))  // NaN too
    judgement.add(Verdict::kFailService,
                  make_reason("%.*s: fits worst of a joint solution with chi2 per degree of freedom of %.1f (limit "
                              "%.1f): check its intrinsics, the map, and that nothing moved",
                              name.length, name.text, ratio, limits.max_chi2_per_dof));
  else
    judgement.add(Verdict::kPassAdvise,
                  make_reason("%.*s: fits worst of a joint solution with chi2 per degree of freedom of %.1f (1 is "
                              "clean): its intrinsics or the map are worse than they claim",
                              name.length, name.text, ratio));
}

void judge_held_out(const HeldOut& held_out, const Limits& limits, Judgement& judgement) {
  if (held_out.markers == 0 || held_out.median_sigmas <= limits.advise_held_out_sigmas) return;
  const bool fail = held_out.median_sigmas > limits.max_held_out_sigmas;
  const Name name(held_out.worst_camera);
  judgement.add(fail ? Verdict::kFailService : Verdict::kPassAdvise,
                make_reason("%.*s: is worst of %zu held-out markers missed by %.1f sigma (1 is clean): check its "
                            "intrinsics and the map",
                            name.length, name.text, held_out.markers, held_out.median_sigmas));
}

bool is_of(const Device& device, const SensorName& name) {
  const auto same = [&](const auto& spec) { return spec.name.view() == name.view(); };
  return std::any_of(device.cameras.begin(), device.cameras.end(), same) ||
         std::any_of(device.lidars.begin(), device.lidars.end(), same);
}

/// What of the installed record could not be compared; a sensor that was not located has its own reason.
void judge_missing(const InstalledCheck& installed, const Device& device, Judgement& judgement) {
  for (const SensorChange& sensor : installed.sensors) {
    if (sensor.comparable || is_of(device, sensor.name)) continue;
    const Name name(sensor.name);
    judgement.add(Verdict::kPassAdvise,
                  make_reason("%.*s: is in the installed record but not in this device: is it this device's record?",
                              name.length, name.text));
  }
}

void judge_installed(const InstalledCheck& installed, Judgement& judgement) {
  if (!installed.moved) return;
  const Name name(installed.moved_sensor);
  const auto change = std::find_if(installed.sensors.begin(), installed.sensors.end(), [&](const SensorChange& sensor) {
    return sensor.name.view() == installed.moved_sensor.view();
  });
  judgement.add(
      Verdict::kPassAdvise,
      make_reason("%.*s: has moved since the installed record (%.1f mm, %.2f deg against the reference, p %.1g): "
                  "tighten its bracket, then calibrate",
                  name.length, name.text, 1e3 * change->delta.head<3>().norm(),
                  rad_to_deg(change->delta.tail<3>().norm()), installed.p_value));
}

}  // namespace

void judge(const Device& device, const Limits& limits, Outcome& outcome) {
  Judgement judgement(outcome);
  for (std::size_t i = 0; i < outcome.cameras.size(); ++i) {
    const CameraOutcome& camera = outcome.cameras[i];
    judge_location(camera, limits, judgement);
    judge_intrinsics(camera, outcome.solution, limits, judgement);
    if (!camera.in_rig || i == outcome.reference) continue;
    judge_covariance(camera.name, camera.cov_rig_cam, limits, judgement);
    judge_mounting(camera.name, device.cameras[i].nominal, camera.T_rig_cam, limits, judgement);
  }
  for (std::size_t i = 0; i < outcome.lidars.size(); ++i)
    judge_lidar(device.lidars[i], outcome.lidars[i], limits, judgement);
  judge_fit(outcome, limits, judgement);
  judge_held_out(outcome.held_out, limits, judgement);
  judge_missing(outcome.installed, device, judgement);
  judge_installed(outcome.installed, judgement);
}

}  // namespace roomcal::calib
