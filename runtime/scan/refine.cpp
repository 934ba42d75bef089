#include "runtime/scan/refine.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

#include "runtime/math/robust_loss.h"

namespace roomcal::scan {

namespace {

constexpr double kTurnOver = 3;       // sigmas
constexpr double kStepSigma_m = 0.3;  // an axis that nothing fixes does not run away
constexpr double kUnmappedLoss = 9;   // half-way between explained and contradicted
constexpr double kEvidence = 12;      // sigmas^2 that a face must explain
constexpr std::size_t kSettlePoints = 600;
constexpr std::size_t kThin = 5;
constexpr int kThinRounds = 5;
constexpr int kFullRounds = 10;
constexpr int kNearRounds = 4;
constexpr double kStuck = 1e3;
constexpr double kConverged = 0.33;  // sigmas
constexpr std::array<double, 6> kSettle_m = {0.35, 0.25, 0.18, 0.12, 0.08, 0.05};

PassOptions pass(const RefineInput& input, std::size_t stride, double turn_over_m) {
  return {stride, input.sigma_m, std::max(kTurnOver, turn_over_m / input.sigma_m), input.mute};
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

namespace {

/// Robust cost of a state, prior included.
double cost_of(const RangeSums& sums, const RefineInput& input, const RangeState& state) {
  double cost = sums.loss + kUnmappedLoss * static_cast<double>(sums.valid - sums.mapped);
  if (input.prior != nullptr) {
    const Vec6 off = se3_log(input.prior->T_room_lidar.inverse() * state.T_room_lidar);
    cost += off.dot(input.prior->cov.llt().solve(off));
  }
  return cost;
}

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

void settle(std::span<const Ray> sample, const RefineInput& input, double reach_m, RangeState& state) {
  RangeSums sums;
  const std::size_t stride = std::max<std::size_t>(1, sample.size() / kSettlePoints);
  for (const double turn_over_m : kSettle_m) {
    if (turn_over_m > reach_m) continue;
    gather(input.surface, sample, input.sensor, state, pass(input, stride, turn_over_m), sums);
    if (step_state(sums, input, state) < 0) return;
  }
  settle_near(sample, input, stride, state);
}

void settle_near(std::span<const Ray> sample, const RefineInput& input, std::size_t stride, RangeState& state) {
  RangeSums sums;
  RangeState linearized_at;
  const auto gather_at = [&](const RangeState& at, RangeSums& into) {
    gather(input.surface, sample, input.sensor, at, pass(input, stride, 0), into);
  };
  (void)descend(gather_at, input, kNearRounds, state, sums, linearized_at);
}

bool refine(const SweepView& view, const RefineInput& input, RangeState& state, RangeSums& sums,
            RangeState& linearized_at) {
  const auto gather_every = [&](std::size_t stride) {
    return [&, stride](const RangeState& at, RangeSums& into) {
      gather(input.surface, view, input.sensor, at, pass(input, stride, 0), into);
    };
  };
  (void)descend(gather_every(kThin), input, kThinRounds, state, sums, linearized_at);
  return descend(gather_every(1), input, kFullRounds, state, sums, linearized_at);
}

double spread_m(std::span<const Ray> sample, const RefineInput& input, const RangeState& state,
                std::span<float> scratch) {
  PosedSurface posed;
  posed.set(input.surface, state.T_room_lidar);
  std::size_t count = 0;
  for (const Ray& ray : sample) {
    const RayHit hit = posed.first_hit(ray.direction_lidar);
    if (hit.face == kNoFace || count == scratch.size()) continue;
    scratch[count++] = static_cast<float>(std::abs(ray.range_m - hit.range_m - state.offset_m[ray.beam]));
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

namespace {

/// Sums, face by face, how much better the face explains its points than the plane behind it would.
class Evidence {
 public:
  Evidence(const RefineInput& input, const RangeState& state)
      : state_(state), information_(1 / (input.sigma_m * input.sigma_m)) {
    posed_.set(input.surface, state.T_room_lidar);
  }

  void add(const Ray& ray) {
    const RayHits hits = posed_.first_two_hits(ray.direction_lidar);
    if (hits.first.face == kNoFace) return;
    const double with = loss_of(ray, hits.first);
    const double without = hits.second.face == kNoFace ? kUnmappedLoss : loss_of(ray, hits.second);
    sum_[static_cast<std::size_t>(hits.first.face)] += without - with;
  }

  uint64_t faces_below(double least) const {
    uint64_t mute = 0;
    for (std::size_t i = 0; i < posed_.face_count(); ++i) {
      if (sum_[i] < least) mute |= uint64_t{1} << i;
    }
    return mute;
  }

 private:
  double loss_of(const Ray& ray, const RayHit& hit) const {
    const double residual_m = ray.range_m - state_.offset_m[ray.beam] - hit.range_m;
    return loss_(residual_m * residual_m * information_).loss;
  }

  const RangeState& state_;
  double information_;
  RedescendingLoss loss_{kTurnOver};
  PosedSurface posed_;
  std::array<double, kMaxFaces> sum_{};
};
static_assert(kMaxFaces <= 64, "one bit a face");

}  // namespace

uint64_t faces_without_evidence(std::span<const Ray> sample, const RefineInput& input, const RangeState& state) {
  Evidence evidence(input, state);
  for (const Ray& ray : sample) evidence.add(ray);
  return evidence.faces_below(kEvidence);
}

uint64_t faces_without_evidence(const SweepView& view, const RefineInput& input, const RangeState& state) {
  Evidence evidence(input, state);
  for_each_ray(view, input.sensor, 1, [&](const Ray& ray) { evidence.add(ray); });
  return evidence.faces_below(kEvidence);
}

}  // namespace roomcal::scan
