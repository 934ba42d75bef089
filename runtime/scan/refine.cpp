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
constexpr double kEvidence = 30;      // sigmas^2 that a face must explain
constexpr std::size_t kSettlePoints = 600;
constexpr std::size_t kThin = 5;
constexpr int kThinRounds = 5;
constexpr int kFullRounds = 8;
constexpr double kConverged = 0.33;  // sigmas
constexpr std::array<double, 7> kSettle_m = {0.35, 0.25, 0.18, 0.12, 0.08, 0.05, 0.05};

PassOptions pass(const RefineInput& input, std::size_t stride, double turn_over_m) {
  return {stride, input.sigma_m, std::max(kTurnOver, turn_over_m / input.sigma_m), input.mute};
}

}  // namespace

double step_state(const RangeSums& sums, const RefineInput& input, RangeState& state) {
  PoseInformation pose = condense(sums, input.sensor, state);
  if (input.prior != nullptr) add_prior(*input.prior, state.T_room_lidar, pose.information, pose.gradient);
  pose.information.diagonal().array() += 1 / (kStepSigma_m * kStepSigma_m);
  const Eigen::LDLT<Mat66> solver(pose.information);
  const Vec6 xi = solver.solve(pose.gradient);
  if (!xi.allFinite()) return -1;
  update_offsets(sums, input.sensor, xi, state);
  state.T_room_lidar = state.T_room_lidar * se3_exp(xi);
  return std::sqrt(std::max(0.0, xi.dot(pose.information * xi)));
}

void settle(std::span<const Ray> sample, const RefineInput& input, RangeState& state) {
  RangeSums sums;
  const std::size_t stride = std::max<std::size_t>(1, sample.size() / kSettlePoints);
  for (const double turn_over_m : kSettle_m) {
    gather(input.surface, sample, input.sensor, state, pass(input, stride, turn_over_m), sums);
    if (step_state(sums, input, state) < 0) return;
  }
  for (int round = 0; round < 2; ++round) {
    gather(input.surface, sample, input.sensor, state, pass(input, 1, 0), sums);
    if (step_state(sums, input, state) < 0) return;
  }
}

bool refine(const SweepView& view, const RefineInput& input, RangeState& state, RangeSums& sums,
            RangeState& linearized_at) {
  for (int round = 0; round < kThinRounds; ++round) {
    gather(input.surface, view, input.sensor, state, pass(input, kThin, 0), sums);
    const double step = step_state(sums, input, state);
    if (step < 0) return false;
    if (step < kConverged) break;
  }
  double step = 0;
  for (int round = 0; round < kFullRounds; ++round) {
    linearized_at = state;
    gather(input.surface, view, input.sensor, state, pass(input, 1, 0), sums);
    step = step_state(sums, input, state);
    if (step >= 0 && step < kConverged) return true;
  }
  return step >= 0 && step < 2 * kConverged;
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

uint64_t faces_without_evidence(std::span<const Ray> sample, double share, const RefineInput& input,
                                const RangeState& state) {
  static_assert(kMaxFaces <= 64, "one bit a face");
  PosedSurface posed;
  posed.set(input.surface, state.T_room_lidar);
  const RedescendingLoss loss(kTurnOver);
  const double information = 1 / (input.sigma_m * input.sigma_m);
  std::array<double, kMaxFaces> evidence{};
  for (const Ray& ray : sample) {
    const RayHits hits = posed.first_two_hits(ray.direction_lidar);
    if (hits.first.face == kNoFace) continue;
    const double measured_m = ray.range_m - state.offset_m[ray.beam];
    const double with_m = measured_m - hits.first.range_m, without_m = measured_m - hits.second.range_m;
    const double with = loss(with_m * with_m * information).loss;
    const double without = hits.second.face == kNoFace ? kUnmappedLoss : loss(without_m * without_m * information).loss;
    evidence[static_cast<std::size_t>(hits.first.face)] += without - with;
  }
  uint64_t mute = 0;
  for (std::size_t i = 0; i < posed.face_count(); ++i) {
    if (evidence[i] < kEvidence * share) mute |= uint64_t{1} << i;
  }
  return mute;
}

}  // namespace roomcal::scan
