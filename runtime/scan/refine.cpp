#include "runtime/scan/refine.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

#include "runtime/scan/ray_cast.h"

namespace roomcal::scan {

namespace {

constexpr double kTurnOver = 3;       // sigmas
constexpr double kStepSigma_m = 0.3;  // an axis that nothing fixes does not run away
constexpr double kEvidence = 30;      // sigmas^2 that a face must explain
constexpr std::size_t kThin = 5;
constexpr int kThinRounds = 5;
constexpr int kFirstRounds = 2;  // over all points, before the faces are judged
constexpr int kFullRounds = 10;
constexpr int kMuteRounds = 3;
constexpr int kNearRounds = 4;
constexpr double kStuck = 1e3;
constexpr double kConverged = 0.33;  // sigmas
constexpr std::array<double, 6> kSettle_m = {0.35, 0.25, 0.18, 0.12, 0.08, 0.05};

PassOptions pass(const RefineInput& input, double turn_over_m, bool evidence = false) {
  return {input.sigma_m, std::max(kTurnOver, turn_over_m / input.sigma_m), input.mute, evidence};
}

}  // namespace

double step_state(const RangeSums& sums, const RefineInput& input, RangeState& state, double damping) {
  PoseInformation pose = condense(sums, input.sensor, state);
  if (input.prior != nullptr) add_prior(*input.prior, state.T_room_lidar, pose.information, pose.gradient);
  const Mat66 information = pose.information;
  pose.information.diagonal() *= 1 + damping;
  pose.information.diagonal().array() += 1 / (kStepSigma_m * kStepSigma_m);
  const Eigen::LDLT<Mat66> solver(pose.information);
  const Vec6 xi = solver.solve(pose.gradient);
  if (!xi.allFinite()) return -1;
  update_offsets(sums, input.sensor, xi, state);
  state.T_room_lidar = state.T_room_lidar * se3_exp(xi);
  return std::sqrt(std::max(0.0, xi.dot(information * xi)));
}

double cost_of(const RangeSums& sums, const RefineInput& input, const RangeState& state) {
  double cost = sums.loss + kUnmappedLoss * static_cast<double>(sums.valid - sums.mapped);
  if (input.prior != nullptr) {
    const Vec6 off = se3_log(input.prior->T_room_lidar.inverse() * state.T_room_lidar);
    cost += off.dot(input.prior->cov.llt().solve(off));
  }
  return cost;
}

namespace {

/// Levenberg-Marquardt: steps that raise the cost are taken back and shortened. Few grazing returns on a narrow face
/// may be all that fixes an axis, and a whole Gauss-Newton step jumps off that face.
/// @param gather_at  (state, sums): one pass.
/// @param[out] sums  gathered at linearized_at, which is the final state or a converged step before it.
template <typename Gather>
bool descend(const Gather& gather_at, const RefineInput& input, int rounds, RangeState& state, RangeSums& sums,
             RangeState& linearized_at) {
  gather_at(state, sums);
  linearized_at = state;
  double damping = 0;
  for (int round = 0; round < rounds; ++round) {
    RangeState next = state;
    const double step = step_state(sums, input, next, damping);
    if (step < 0) return false;
    if (step < kConverged) {
      state = next;
      return true;
    }
    RangeSums next_sums;
    gather_at(next, next_sums);
    if (cost_of(next_sums, input, next) < cost_of(sums, input, state)) {
      state = linearized_at = next;
      sums = next_sums;
      damping /= 10;
    } else {
      damping = std::max(0.1, 10 * damping);
      if (damping > kStuck) return true;  // no way down: the kinks of the surface make minima without a flat bottom
    }
  }
  return false;
}

}  // namespace

void settle(std::span<const RayBlock> sample, const RefineInput& input, double reach_m, RangeState& state) {
  RangeSums sums;
  for (const double turn_over_m : kSettle_m) {
    if (turn_over_m > reach_m) continue;
    gather(input.surface, sample, input.sensor, state, pass(input, turn_over_m), sums);
    if (step_state(sums, input, state) < 0) return;
  }
  settle_near(sample, input, state);
}

void settle_near(std::span<const RayBlock> sample, const RefineInput& input, RangeState& state) {
  RangeSums sums;
  RangeState linearized_at;
  const auto gather_at = [&](const RangeState& at, RangeSums& into) {
    gather(input.surface, sample, input.sensor, at, pass(input, 0), into);
  };
  (void)descend(gather_at, input, kNearRounds, state, sums, linearized_at);
}

namespace {

/// Bits of faces that most of their points do not fit: what is left of them is the rim of something else.
uint64_t faces_mostly_missed(const RangeSums& sums) {
  uint64_t mute = 0;
  for (std::size_t i = 0; i < kMaxFaces; ++i) {
    if (2 * sums.face[i].inliers < sums.face[i].predicted) mute |= uint64_t{1} << i;
  }
  return mute;
}

uint64_t faces_seen(const RangeSums& sums) {
  uint64_t seen = 0;
  for (std::size_t i = 0; i < kMaxFaces; ++i) seen |= (sums.face[i].predicted > 0 ? uint64_t{1} : uint64_t{0}) << i;
  return seen;
}

}  // namespace

void refine(const SweepView& view, RefineInput& input, FineSolution& fine) {
  const auto gather_thin = [&](const RangeState& at, RangeSums& into) {
    gather(input.surface, view, kThin, input.sensor, at, pass(input, 0), into);
  };
  (void)descend(gather_thin, input, kThinRounds, fine.state, fine.sums, fine.linearized_at);
  refine_fully(view, input, fine);
}

void refine_fully(const SweepView& view, RefineInput& input, FineSolution& fine) {
  const auto gather_all = [&](const RangeState& at, RangeSums& into) {
    gather(input.surface, view, 1, input.sensor, at, pass(input, 0, true), into);
  };
  // Grazing beams that change sides keep a solution from settling: mute first, complain later.
  for (int round = 0; round < kMuteRounds; ++round) {
    const int rounds = round == 0 ? kFirstRounds : kFullRounds;
    fine.converged = descend(gather_all, input, rounds, fine.state, fine.sums, fine.linearized_at);
    const uint64_t mute = faces_without_evidence(fine.sums) | faces_mostly_missed(fine.sums);
    const bool same = ((mute ^ input.mute) & faces_seen(fine.sums)) == 0;
    if (same && fine.converged) break;
    if (round + 1 < kMuteRounds) input.mute = mute;
  }
}

double spread_m(std::span<const RayBlock> sample, const RefineInput& input, const RangeState& state,
                std::span<float> scratch) {
  const PosedSurface posed(input.surface, state.T_room_lidar);
  std::size_t count = 0;
  for (const RayBlock& block : sample) {
    BlockHits hits;
    posed.cast(block, hits);
    for (std::size_t i = 0; i < block.count && count < scratch.size(); ++i) {
      const auto face = static_cast<std::size_t>(hits.face[i]);
      if (!(posed.height_m()[face] > 0)) continue;
      const auto offset_m = static_cast<float>(state.offset_m[block.beam[i]]);
      scratch[count++] = std::abs(block.range_m[i] - 1 / hits.inverse_m[i] - offset_m);
    }
  }
  double sigma_m = 10;
  for (int round = 0; round < 6; ++round) {
    const auto end = std::partition(scratch.begin(), scratch.begin() + static_cast<std::ptrdiff_t>(count),
                                    [&](float r) { return static_cast<double>(r) < 3 * sigma_m; });
    const auto near = end - scratch.begin();
    if (near < 2) break;
    std::nth_element(scratch.begin(), scratch.begin() + near / 2, end);
    sigma_m = 1.4826 * static_cast<double>(scratch[static_cast<std::size_t>(near / 2)]);
  }
  constexpr double kScatter = 1.2;
  return sigma_m > kScatter * input.sensor.sigma_m ? std::min(sigma_m, 0.1) : input.sensor.sigma_m;
}

double mean_loss(const RangeSums& sums) {
  if (sums.valid == 0) return 3 * kTurnOver * kTurnOver;
  const double unmapped = static_cast<double>(sums.valid - sums.mapped);
  return (sums.loss + kUnmappedLoss * unmapped) / static_cast<double>(sums.valid);
}

uint64_t faces_without_evidence(const RangeSums& sums) {
  uint64_t mute = 0;
  for (std::size_t i = 0; i < kMaxFaces; ++i) {
    if (sums.face[i].evidence < kEvidence) mute |= uint64_t{1} << i;
  }
  return mute;
}
static_assert(kMaxFaces <= 64, "one bit a face");

}  // namespace roomcal::scan
