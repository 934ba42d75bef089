#include "runtime/scan/weigh_block.h"

#include <cmath>

#include "runtime/base/vector_clones.h"
#include "runtime/math/robust_loss.h"

// Compiled as vector code, see CMakeLists.txt.
namespace roomcal::scan {

namespace {

constexpr float kMinCosIncidence = 0.08F;  // flatter than 85 degrees, a return says where the beam's rim was
constexpr float kBeyond = 5;               // sigmas behind a face that count as seen through it

/// What belongs to each ray by its face and beam.
struct Looked {
  alignas(64) BlockFloats gx, gy, gz, height_m, face_weight, offset_m;
};

void look_up(const PosedSurface& posed, const RayBlock& block, const BlockHits& hits, const WeighOptions& options,
             Looked& looked) {
  for (std::size_t i = 0; i < kBlockRays; ++i) {
    const auto face = static_cast<std::size_t>(hits.face[i]);
    looked.gx[i] = posed.gx()[face];
    looked.gy[i] = posed.gy()[face];
    looked.gz[i] = posed.gz()[face];
    looked.height_m[i] = posed.height_m()[face];
    looked.face_weight[i] = options.face_weight[face];
    looked.offset_m[i] = options.offset_m[block.beam[i]];
  }
}

/// RedescendingLoss in floats.
struct Robust {
  float loss, weight;
};
Robust robust_of(float squared, float turn_over) {
  const float ratio = turn_over / std::sqrt(squared > 1e-12F ? squared : 1e-12F);
  const float far_loss = turn_over * turn_over * (3 - 2 * ratio), far_weight = ratio * ratio * ratio;
  return {ratio >= 1 ? squared : far_loss, ratio >= 1 ? 1 : far_weight};
}

/// Predicted ranges, 1 where there is none; residuals and their information.
struct Predicted {
  alignas(64) BlockFloats cos_incidence, range_m;
};
void predict(const RayBlock& block, const BlockHits& hits, const WeighOptions& options, const Looked& looked,
             Predicted& predicted, WeighedBlock& weighed) {
  const float variance_m2 = options.variance_m2, angle_variance = options.angle_variance;
  for (std::size_t i = 0; i < kBlockRays; ++i) {
    const float inverse_m = hits.inverse_m[i];
    const float cos_incidence = looked.height_m[i] * inverse_m;
    const float cos = cos_incidence >= kMinCosIncidence ? cos_incidence : 1;
    const float range_m = 1 / (cos_incidence >= kMinCosIncidence ? inverse_m : 1);
    const float tan2 = 1 / (cos * cos) - 1;
    weighed.information[i] = 1 / (variance_m2 + angle_variance * tan2 * range_m * range_m);
    weighed.residual_m[i] = block.range_m[i] - range_m - looked.offset_m[i];
    predicted.cos_incidence[i] = cos_incidence;
    predicted.range_m[i] = range_m;
  }
}

void derive(const RayBlock& block, const Looked& looked, const BlockFloats& range_m, WeighedBlock& weighed) {
  for (std::size_t i = 0; i < kBlockRays; ++i) {
    const float x = looked.gx[i] * range_m[i], y = looked.gy[i] * range_m[i], z = looked.gz[i] * range_m[i];
    weighed.J[0][i] = -x;
    weighed.J[1][i] = -y;
    weighed.J[2][i] = -z;
    weighed.J[3][i] = -range_m[i] * (block.y[i] * z - block.z[i] * y);
    weighed.J[4][i] = -range_m[i] * (block.z[i] * x - block.x[i] * z);
    weighed.J[5][i] = -range_m[i] * (block.x[i] * y - block.y[i] * x);
  }
}

}  // namespace

// Choices are written as selections between values, one after the other: what branches is not made vector code.
ROOMCAL_VECTOR_CLONES void weigh_block(const PosedSurface& posed, const RayBlock& block, const BlockHits& hits,
                                       const WeighOptions& options, WeighedBlock& weighed) {
  Looked looked;
  Predicted predicted;
  look_up(posed, block, hits, options, looked);
  predict(block, hits, options, looked, predicted, weighed);
  derive(block, looked, predicted.range_m, weighed);
  constexpr auto kOutlierWeight = static_cast<float>(RedescendingLoss::kOutlierWeight);
  const float turn_over = options.turn_over, max_loss = 3 * turn_over * turn_over;
  for (std::size_t i = 0; i < kBlockRays; ++i) {
    const float residual_m = weighed.residual_m[i], information = weighed.information[i];
    const float squared = residual_m * residual_m * information;
    const Robust robust = robust_of(squared, turn_over);
    const float height_m = looked.height_m[i];
    const float behind_loss = height_m < 0 ? max_loss : 0;
    const int32_t behind = height_m < 0 ? kRayBeyond : 0;
    const int32_t inlier = robust.weight >= kOutlierWeight ? kRayMapped | kRayInlier : kRayMapped;
    const float farther_m = squared > kBeyond * kBeyond ? residual_m : 0;
    const int32_t beyond = farther_m > 0 ? kRayBeyond : 0;
    const float inlier_squares = robust.weight >= kOutlierWeight ? squared : 0;
    const float weight = robust.weight * information * looked.face_weight[i];
    const float cos_incidence = predicted.cos_incidence[i];
    weighed.weight[i] = cos_incidence >= kMinCosIncidence ? weight : 0;
    weighed.loss[i] = cos_incidence >= kMinCosIncidence ? robust.loss : behind_loss;
    weighed.inlier_squares[i] = cos_incidence >= kMinCosIncidence ? inlier_squares : 0;
    weighed.flags[i] = cos_incidence >= kMinCosIncidence ? inlier | beyond : behind;
  }
}

ROOMCAL_VECTOR_CLONES void weigh_evidence(const RayBlock& block, const BlockHits& behind, const WeighOptions& options,
                                          const WeighedBlock& weighed, float nothing_behind, BlockFloats& evidence) {
  const float turn_over = options.turn_over;
  alignas(64) BlockFloats offset_m;
  for (std::size_t i = 0; i < kBlockRays; ++i) offset_m[i] = options.offset_m[block.beam[i]];
  for (std::size_t i = 0; i < kBlockRays; ++i) {
    const float inverse_m = behind.inverse_m[i], loss = weighed.loss[i];
    const float range_m = 1 / (inverse_m > 0 ? inverse_m : 1);
    const float residual_m = block.range_m[i] - range_m - offset_m[i];
    const float at_behind = robust_of(residual_m * residual_m * weighed.information[i], turn_over).loss;
    const float without = inverse_m > 0 ? at_behind : nothing_behind;
    evidence[i] = (weighed.flags[i] & kRayMapped) != 0 ? without - loss : 0;
  }
}

ROOMCAL_VECTOR_CLONES void add_block(const WeighedBlock& weighed, LaneSums& sums) {
  constexpr std::size_t kLanes = LaneSums::kLanes;
  alignas(64) BlockFloats scaled;
  const auto add_product = [&](const BlockFloats& a, const BlockFloats& b, std::size_t which) {
    alignas(64) std::array<float, kLanes> lane{};
    for (std::size_t first = 0; first < kBlockRays; first += kLanes) {
      for (std::size_t j = 0; j < kLanes; ++j) lane[j] += a[first + j] * b[first + j];
    }
    for (std::size_t j = 0; j < kLanes; ++j) sums.sum[which][j] += static_cast<double>(lane[j]);
  };
  const auto add_plain = [&](const BlockFloats& a, std::size_t which) {
    alignas(64) std::array<float, kLanes> lane{};
    for (std::size_t first = 0; first < kBlockRays; first += kLanes) {
      for (std::size_t j = 0; j < kLanes; ++j) lane[j] += a[first + j];
    }
    for (std::size_t j = 0; j < kLanes; ++j) sums.sum[which][j] += static_cast<double>(lane[j]);
  };
  std::size_t which = 0;
  for (std::size_t c = 0; c < 6; ++c) {
    for (std::size_t i = 0; i < kBlockRays; ++i) scaled[i] = weighed.weight[i] * weighed.J[c][i];
    for (std::size_t r = c; r < 6; ++r) add_product(scaled, weighed.J[r], which++);
    add_product(scaled, weighed.residual_m, LaneSums::kProducts + c);
  }
  add_plain(weighed.loss, LaneSums::kLoss);
  add_plain(weighed.inlier_squares, LaneSums::kInlierSquares);
}

double LaneSums::total(std::size_t which) const {
  double total = 0;
  for (const double lane : sum[which]) total += lane;
  return total;
}

}  // namespace roomcal::scan
