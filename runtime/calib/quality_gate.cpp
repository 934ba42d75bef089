#include "runtime/calib/quality_gate.h"

#include <algorithm>
#include <cmath>

#include "runtime/calib/reason.h"

namespace roomcal::calib {

namespace {

/// Collects reasons; the verdict is the worst that any of them asks for.
class Judgement {
 public:
  explicit Judgement(Outcome& outcome) : outcome_(outcome) {
    outcome_.verdict = Verdict::kPass;
    outcome_.reasons.clear();
  }
  void add(Verdict verdict, const Reason& reason) {
    outcome_.verdict = std::max(outcome_.verdict, verdict);
    // A full list keeps the first reasons: they stand nearest to the cause. The verdict is not lost.
    static_cast<void>(outcome_.reasons.push_back(reason));
  }

 private:
  Outcome& outcome_;
};

struct Name {
  explicit Name(const SensorName& name) : length(static_cast<int>(name.view().size())), text(name.view().data()) {}
  int length;
  const char* text;
};

void judge_location(const CameraOutcome& camera, const Limits& limits, Judgement& judgement) {
  const Name name(camera.name);
  if (!camera.located) return judgement.add(Verdict::kFailRetry, camera.failure);
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

void judge_covariance(const CameraOutcome& camera, const Limits& limits, Judgement& judgement) {
  const Name name(camera.name);
  const double sigma_t_m = std::sqrt(camera.cov_rig_cam.topLeftCorner<3, 3>().diagonal().maxCoeff());
  const double sigma_rot_rad = std::sqrt(camera.cov_rig_cam.bottomRightCorner<3, 3>().diagonal().maxCoeff());
  if (sigma_t_m > limits.max_sigma_t_m || sigma_rot_rad > limits.max_sigma_rot_rad)
    judgement.add(Verdict::kFailRetry,
                  make_reason("%.*s: 1-sigma of %.2f mm and %.3f deg is above %.2f mm and %.3f deg: move the device to "
                              "where it sees more markers",
                              name.length, name.text, 1e3 * sigma_t_m, rad_to_deg(sigma_rot_rad),
                              1e3 * limits.max_sigma_t_m, rad_to_deg(limits.max_sigma_rot_rad)));
}

void judge_mounting(const CameraSpec& spec, const CameraOutcome& camera, const Limits& limits, Judgement& judgement) {
  if (!spec.nominal.known) return;
  const Name name(camera.name);
  const Vec3 offset_m = camera.T_rig_cam.t - spec.nominal.T_rig_cam.t;
  const Vec3 rotation_rad = so3_log(spec.nominal.T_rig_cam.R.transpose() * camera.T_rig_cam.R);
  if (offset_m.cwiseAbs().maxCoeff() > limits.max_nominal_sigmas * spec.nominal.sigma_t_m ||
      rotation_rad.cwiseAbs().maxCoeff() > limits.max_nominal_sigmas * spec.nominal.sigma_rot_rad)
    judgement.add(Verdict::kFailService,
                  make_reason("%.*s: sits %.1f mm and %.2f deg from its nominal mounting: check its bracket, or that "
                              "cameras are not swapped",
                              name.length, name.text, 1e3 * offset_m.norm(), rad_to_deg(rotation_rad.norm())));
}

void judge_fit(const Outcome& outcome, const Limits& limits, Judgement& judgement) {
  if (outcome.solution.degrees_of_freedom <= 0) return;
  const double ratio = outcome.solution.chi2 / outcome.solution.degrees_of_freedom;
  if (ratio > limits.max_chi2_per_dof)
    judgement.add(Verdict::kFailService, make_reason("joint fit: chi2 per degree of freedom is %.1f (limit %.1f): "
                                                     "check the intrinsics, the map, and that nothing moved",
                                                     ratio, limits.max_chi2_per_dof));
  else if (ratio > limits.advise_chi2_per_dof)
    judgement.add(Verdict::kPassAdvise, make_reason("joint fit: chi2 per degree of freedom is %.1f (1 is clean): the "
                                                    "intrinsics or the map are worse than they claim",
                                                    ratio));
}

}  // namespace

void judge(const Device& device, const Limits& limits, Outcome& outcome) {
  Judgement judgement(outcome);
  for (std::size_t i = 0; i < outcome.cameras.size(); ++i) {
    const CameraOutcome& camera = outcome.cameras[i];
    judge_location(camera, limits, judgement);
    if (!camera.in_rig || i == outcome.reference) continue;
    judge_covariance(camera, limits, judgement);
    judge_mounting(device.cameras[i], camera, limits, judgement);
  }
  judge_fit(outcome, limits, judgement);
}

}  // namespace roomcal::calib
