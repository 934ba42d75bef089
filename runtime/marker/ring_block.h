#pragma once

#include <array>
#include <span>

#include "runtime/marker/ring_model.h"

namespace roomcal::marker {

inline constexpr int kBlockPixels = 64;

/// Pixels of one marker, structure of arrays, sorted by radius so that a block of 64 meets few ring edges.
/// x, y: (pixel - origin_px) / scale_px; grey: level 0..255. All spans have `count` rounded up to whole blocks.
struct RingPixels {
  std::span<float> x;
  std::span<float> y;
  std::span<float> grey;
  int count = 0;
};

/// How residuals are weighted: w(e) = 1 / (1 + (e / scale)^2)^2, that is the cost e^2 / (1 + (e / scale)^2).
/// Clipped pixels (>= 254 or <= 1) carry no weight where the model agrees that they should be clipped.
struct ResidualWeighting {
  double scale_grey = 1e6;
};

/// Prediction, residual and Jacobian of up to 64 pixels, weighted by sqrt(w). Rows: see `parameter`.
struct alignas(64) RingBlock {
  /// Twelve rows for Parameter up to kBlur, one for every inner radius that the block meets, the residual last.
  static constexpr int kPadding = 3;  ///< rows of zeros behind the last: the product's tiles are 3 x 4
  static constexpr int kRows = kMaxParameters + 1 + kPadding;
  float row[kRows][kBlockPixels];
  std::array<int, kRows> parameter{};  ///< which unknown a row belongs to; the residual's is kMaxParameters
  int rows = 0;
  alignas(64) float residual[kBlockPixels];  ///< grey levels, data minus model, not weighted
  float weight[kBlockPixels];                ///< robust weight; 0 for padding and clipped pixels
  float radius[kBlockPixels];
  float slope[kBlockPixels];  ///< d model / d r, grey levels: says how much a pixel knows about the geometry
  float direction_x[kBlockPixels], direction_y[kBlockPixels];  ///< unit vector W d / |W d|
};

/// Evaluates pixels [first, first + 64) of a set.
///
/// The Jacobian holds |grad r| fixed where it scales the distance to an edge: the omitted term is the distance
/// to the edge over the radius of the marker, a few per cent of the others, and vanishes on the edge.
void evaluate_block(const RingModel& model, const RingPixels& pixels, int first, const ResidualWeighting& weighting,
                    RingBlock& block);

/// Gauss-Newton sums over blocks, double precision. H: weighted J^T J, the upper triangle; g: J^T e.
struct NormalEquations {
  std::array<std::array<double, kMaxParameters + 1>, kMaxParameters + 1> sum{};  ///< last row and column: residual
  double cost = 0;                                                               ///< robust cost, grey levels squared
  /// Sums over the pixels, psi = w e being the robust influence: w, psi^2 and d psi / d e. Weighted steps fall short
  /// by weight / slope; the covariance per unit of the inverse is influence2 * weight / slope^2.
  double weight = 0, influence2 = 0, slope = 0;
  double neighbours = 0;  ///< sum of psi of a pixel times psi of the next: zero for noise, positive for a misfit

  double hessian(int i, int j) const { return sum[index(i < j ? i : j)][index(i < j ? j : i)]; }
  double gradient(int i) const { return sum[index(i)][kMaxParameters]; }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
};

/// Adds one evaluated block.
void accumulate(const RingBlock& block, NormalEquations& equations);

}  // namespace roomcal::marker
