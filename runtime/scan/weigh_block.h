#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "runtime/scan/ray_cast.h"

namespace roomcal::scan {

/// What a pass weighs the rays of a block by.
struct WeighOptions {
  float variance_m2 = 0;     ///< of one range
  float angle_variance = 0;  ///< of a beam's direction, rad^2
  float turn_over = 3;       ///< of RedescendingLoss, sigmas
  FaceFloats face_weight;    ///< 0: points on it carry no weight
  std::array<float, kMaxBeams> offset_m;
};

/// Bits of WeighedBlock::flags.
enum RayFlag : int32_t {
  kRayMapped = 1,  ///< has a prediction: a face in front, not too flat
  kRayInlier = 2,  ///< lies on it
  kRayBeyond = 4,  ///< came from well behind it, or meets the back of one: seen through a wall
};

/// Residuals of a block's rays and their derivatives by (rho, phi) of a right perturbation of the pose, and 1 by the
/// beam's offset. With g of the face (see PosedSurface) and the predicted range r along d:
///     residual = range - offset - r,  r = 1 / (g . d),  dr / drho = -g r,  dr / dphi = -r^2 (d x g).
/// Source: derivative of n . T p + h = 0 by T exp(xi); held to a numeric one in the tests.
struct WeighedBlock {
  alignas(64) std::array<BlockFloats, 6> J;
  alignas(64) BlockFloats weight;       ///< robust weight times information, 1 / m^2; 0: takes no part
  alignas(64) BlockFloats information;  ///< 1 / m^2, of mapped rays
  alignas(64) BlockFloats residual_m;
  alignas(64) BlockFloats loss;            ///< robust, sigmas^2; of mapped and of contradicted rays
  alignas(64) BlockFloats inlier_squares;  ///< sigmas^2
  alignas(64) std::array<int32_t, kBlockRays> flags;
};

/// Cost: some 2 ns a ray.
void weigh_block(const PosedSurface& posed, const RayBlock& block, const BlockHits& hits, const WeighOptions& options,
                 WeighedBlock& weighed);

/// How much better each ray is explained by its face than by the plane behind it, sigmas^2; 0 where it has no face.
/// @param nothing_behind  loss of a ray with no plane behind its face.
void weigh_evidence(const RayBlock& block, const BlockHits& behind, const WeighOptions& options,
                    const WeighedBlock& weighed, float nothing_behind, BlockFloats& evidence);

/// Sums over blocks in a fixed order: a lane's sum is of every 16th ray, in double precision from block to block.
/// Products of floats are rounded each for itself, so what the sums say of an axis that nothing shows stays below
/// 1e-8 of what they say of the others.
struct LaneSums {
  static constexpr std::size_t kLanes = 16;
  static constexpr std::size_t kProducts = 21;  ///< w J J', lower triangle by columns
  static constexpr std::size_t kGradient = 6;   ///< w residual J
  static constexpr std::size_t kLoss = kProducts + kGradient, kInlierSquares = kLoss + 1, kCount = kLoss + 2;
  alignas(64) std::array<std::array<double, kLanes>, kCount> sum{};

  double total(std::size_t which) const;
};
void add_block(const WeighedBlock& weighed, LaneSums& sums);

}  // namespace roomcal::scan
