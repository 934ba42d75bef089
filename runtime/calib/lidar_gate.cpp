#include "runtime/calib/lidar_gate.h"

#include <cmath>

namespace roomcal::calib {

namespace {

bool beyond(const scan::WeakDirection& weak, const Limits& limits) {
  return weak.sigma > (weak.rotation ? limits.max_sigma_rot_rad : limits.max_sigma_t_m);
}

/// Names the directions beyond the limits of an extrinsic. @return whether there is any.
bool judge_weak(const LidarOutcome& lidar, const Limits& limits, Judgement& judgement) {
  const Name name(lidar.name);
  bool any = false;
  for (const scan::WeakDirection& weak : lidar.location.weak) {
    if (!beyond(weak, limits)) continue;
    any = true;
    const FixedText<96> what = scan::describe(weak);
    judgement.add(lidar.mount_took_part ? Verdict::kPassAdvise : Verdict::kFailRetry,
                  make_reason("%.*s: %.*s%s: stand where it sees floor or ceiling, or tilt the device", name.length,
                              name.text, static_cast<int>(what.view().size()), what.view().data(),
                              lidar.mount_took_part ? " (its mounting carries it)" : ""));
  }
  return any;
}

void judge_sweeps(const LidarOutcome& lidar, Judgement& judgement) {
  if (lidar.used_sweeps == lidar.sweeps) return;
  const Name name(lidar.name);
  judgement.add(Verdict::kPassAdvise,
                make_reason("%.*s: %zu of its %zu sweeps were left out, not whole: check its network if that goes on",
                            name.length, name.text, lidar.sweeps - lidar.used_sweeps, lidar.sweeps));
}

void judge_beams(const LidarSpec& spec, const LidarOutcome& lidar, const Limits& limits, Judgement& judgement) {
  const Name name(lidar.name);
  for (std::size_t k = 0; k < lidar.location.beam_count; ++k) {
    const scan::BeamOffset& beam = lidar.location.beam[k];
    if (beam.points == 0 || std::abs(beam.offset_m) <= limits.advise_beam_sigmas * spec.ranges.beam_offset_sigma_m)
      continue;
    judgement.add(Verdict::kPassAdvise, make_reason("%.*s: beam %zu is off by %.0f mm in range: have the unit serviced",
                                                    name.length, name.text, k, 1e3 * beam.offset_m));
    return;  // one beam is enough to send it in
  }
}

/// The covariance of an extrinsic without the directions that were named: those carry the mounting's.
Mat66 covariance_of_the_rest(const LidarOutcome& lidar, const Limits& limits) {
  Mat66 seen = Mat66::Identity();
  for (const scan::WeakDirection& weak : lidar.location.weak) {
    if (!beyond(weak, limits)) continue;
    const Vec3 axis_lidar = lidar.T_room_lidar.R.transpose() * weak.axis_room;
    seen.block<3, 3>(weak.rotation ? 3 : 0, weak.rotation ? 3 : 0) -= axis_lidar * axis_lidar.transpose();
  }
  return seen * lidar.cov_rig_lidar * seen.transpose();
}

}  // namespace

void judge_lidar(const LidarSpec& spec, const LidarOutcome& lidar, const Limits& limits, Judgement& judgement) {
  if (!lidar.located) return judgement.add(lidar.failure_verdict, lidar.failure);
  judge_sweeps(lidar, judgement);
  judge_beams(spec, lidar, limits, judgement);
  const bool weak = judge_weak(lidar, limits, judgement);
  if (!lidar.in_rig) return;
  judge_covariance(lidar.name, weak ? covariance_of_the_rest(lidar, limits) : lidar.cov_rig_lidar, limits, judgement);
  judge_mounting(lidar.name, spec.nominal, lidar.T_rig_lidar, limits, judgement);
}

}  // namespace roomcal::calib
