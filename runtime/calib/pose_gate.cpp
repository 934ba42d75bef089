#include <cmath>

#include "runtime/calib/judgement.h"

namespace roomcal::calib {

void judge_covariance(const SensorName& sensor, const Mat66& cov_rig_sensor, const Limits& limits,
                      Judgement& judgement) {
  const Name name(sensor);
  const double sigma_t_m = std::sqrt(cov_rig_sensor.topLeftCorner<3, 3>().diagonal().maxCoeff<Eigen::PropagateNaN>());
  const double sigma_rot_rad =
      std::sqrt(cov_rig_sensor.bottomRightCorner<3, 3>().diagonal().maxCoeff<Eigen::PropagateNaN>());
  if (sigma_t_m <= limits.max_sigma_t_m && sigma_rot_rad <= limits.max_sigma_rot_rad) return;  // NaN is not
  const double map_sigma_m = judgement.map_sigma_m();
  const Reason again =
      map_sigma_m > limits.max_sigma_t_m
          ? make_reason("survey the room again, its map is good to %.1f mm only, or ", 1e3 * map_sigma_m)
          : Reason();
  judgement.add(
      Verdict::kFailRetry,
      make_reason("%.*s: 1-sigma of %.2f mm and %.3f deg is above %.2f mm and %.3f deg: %.*smove the device "
                  "to where it sees more of the room",
                  name.length, name.text, 1e3 * sigma_t_m, rad_to_deg(sigma_rot_rad), 1e3 * limits.max_sigma_t_m,
                  rad_to_deg(limits.max_sigma_rot_rad), static_cast<int>(again.view().size()), again.view().data()));
}

void judge_mounting(const SensorName& sensor, const NominalMounting& nominal, const SE3& T_rig_sensor,
                    const Limits& limits, Judgement& judgement) {
  if (!nominal.known) return;
  const Name name(sensor);
  const Vec3 offset_m = T_rig_sensor.t - nominal.T_rig_sensor.t;
  const Vec3 rotation_rad = so3_log(nominal.T_rig_sensor.R.transpose() * T_rig_sensor.R);
  // Asked so that NaN is no fit.
  if (!((offset_m.cwiseAbs().array() <= limits.max_nominal_sigmas * nominal.sigma_t_m).all() &&
        (rotation_rad.cwiseAbs().array() <= limits.max_nominal_sigmas * nominal.sigma_rot_rad).all()))
    judgement.add(Verdict::kFailService,
                  make_reason("%.*s: sits %.1f mm and %.2f deg from its nominal mounting: check its bracket, or that "
                              "sensors are not swapped",
                              name.length, name.text, 1e3 * offset_m.norm(), rad_to_deg(rotation_rad.norm())));
}

}  // namespace roomcal::calib
