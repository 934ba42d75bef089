#include "runtime/scan/by_prints.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "runtime/scan/open_axis.h"

namespace roomcal::scan {

namespace {

constexpr double kCloseSigma_m = 0.002;   // prints are asked for an axis that ranges fix worse
constexpr double kUnknownReach_m = 1.0;   // of prints, without a prior
constexpr double kRepeatReach_m = 0.15;   // of a second look, from where the first one led
constexpr double kPrintsAgree_m = 0.004;  // two looks
constexpr int kPrintRounds = 4;
constexpr double kPrintSigma_m = 0.0005;  // surveys do not place sheets better
constexpr double kTwinRunnerUp = 0.5;     // of the best twin's gain

/// Fits along the axis until a fit stays where it starts: each holds the faces as they are seen from there.
/// @param[in,out] moved  where it ends. @return whether it does.
bool fit_until_it_stays(const SweepView& view, PrintMatcher& matcher, const RefineInput& input, const Vec3& axis_room,
                        double reach_m, RangeState& moved, PrintFit& fit) {
  for (int round = 0; round < kPrintRounds; ++round) {
    fit = matcher.fit(input.surface, view, input.sensor, moved, axis_room, reach_m);
    if (!fit.clear) return false;
    moved.T_room_lidar.t += fit.shift_m * axis_room;
    if (std::abs(fit.shift_m) < kPrintsAgree_m) return true;
    reach_m = kRepeatReach_m;
  }
  return false;
}

}  // namespace

bool tell_twins_apart(const SweepView& view, const RefineInput& input, PrintMatcher& matcher,
                      CandidateSet& candidates) {
  std::array<double, kMaxTwins> gain{};
  std::size_t best = 0;
  bool informative = false;
  for (std::size_t i = 0; i < candidates.twins.size(); ++i) {
    const Candidate& twin = candidates.twins[i];
    const OpenAxis open = open_axis_of(twin.information, twin.state.T_room_lidar.R, input.prior, kUnknownReach_m);
    const PrintFit fit =
        matcher.fit(input.surface, view, input.sensor, twin.state, open.axis_room, open.open ? open.reach_m : 0);
    informative |= fit.informative;
    gain[i] = fit.gain;
    if (gain[i] > gain[best]) best = i;
  }
  double runner_up = 0;
  for (std::size_t i = 0; i < candidates.twins.size(); ++i) {
    if (i != best) runner_up = std::max(runner_up, gain[i]);
  }
  if (gain[best] < PrintMatcher::kSignificant) return !informative;
  if (runner_up > kTwinRunnerUp * gain[best]) return true;
  candidates.twins[0] = candidates.twins[best];
  candidates.twins.truncate(1);
  return true;
}

PrintMeasurement close_axis(const SweepView& view, PrintMatcher& matcher, RefineInput input, FineSolution& fine) {
  PrintMeasurement measured;
  const Mat33 R = fine.state.T_room_lidar.R;
  const Mat66 information = condense(fine.sums, input.sensor, fine.linearized_at).information;
  const OpenAxis open = open_axis_of(information, R, input.prior, kUnknownReach_m);
  if (open.sigma_m < kCloseSigma_m) return measured;
  const double most_m = open.open ? std::max(kRepeatReach_m, open.reach_m) : kRepeatReach_m;
  const double reach_m = std::clamp(3 * open.sigma_m, kRepeatReach_m, most_m);
  RangeState moved = fine.state;
  PrintFit fit;
  if (!fit_until_it_stays(view, matcher, input, open.axis_room, reach_m, moved, fit)) return measured;
  const Vec3 axis_lidar = R.transpose() * open.axis_room;
  measured.J << axis_lidar, fit.centre_lidar.cross(axis_lidar);
  const double sigma_m = std::max(kPrintSigma_m, fit.sigma_m);
  measured.weight = 1 / (sigma_m * sigma_m);
  measured.points = fit.points;

  fine.state = moved;
  Mat66 joined = measured.weight * measured.J * measured.J.transpose() + 1e-3 * Mat66::Identity();
  if (input.prior != nullptr) joined += input.prior->cov.inverse();
  const PosePrior with_prints{moved.T_room_lidar, joined.inverse()};
  input.prior = &with_prints;
  refine_fully(view, input, fine);
  return measured;
}

}  // namespace roomcal::scan
