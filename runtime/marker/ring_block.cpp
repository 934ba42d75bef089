#include "runtime/marker/ring_block.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/base/vector_clones.h"

// Compiled with -fno-math-errno -fno-trapping-math (see CMakeLists.txt): plain loops over 64 floats become vector code.
namespace roomcal::marker {
namespace {

// Beyond this many sigma an edge is a plain step.
constexpr float kEdgeReach = 3.2F;

// The second-order terms are limited so that |t0| = kFarReach always gives |t| > kEdgeReach: far pixels see no edge.
constexpr float kMaxBend = 0.04F;
constexpr float kMaxShift = 0.3F;
constexpr float kFarReach = 4.5F;
static_assert(kFarReach * (1 - kMaxBend * kFarReach) - kMaxShift > kEdgeReach);

// Odd polynomial for Phi(t) - 1/2 on |t| <= 3.2, value 1/2 and slope 0 at the ends, least squares in between; off by
// 7e-4 at most. Its exact derivative stands in for the density, so that model and Jacobian agree.
constexpr std::array<float, 6> kStep{0.398669426F,     -0.0656465649F,  0.0092134411F,
                                     -0.000880839581F, 4.98586631e-05F, -1.23195164e-06F};

struct BlockGeometry {
  alignas(64) float dx[kBlockPixels];
  float dy[kBlockPixels];
  float inverse_line[kBlockPixels];  // 1 / (1 + h . d)
  float gradient_x[kBlockPixels];    // d r / d x
  float gradient_y[kBlockPixels];
  float inverse_distance[kBlockPixels];  // 1 / (|grad r| sigma): r to sigmas
  float bend[kBlockPixels];              // second order of the distance to an edge: t = t0 (1 + bend t0)
  float shift[kBlockPixels];             // sigma * curvature / 2: blurred curved edges move inwards
  float paper[kBlockPixels];             // w
  float density[kBlockPixels];           // sum_j s_j phi(t_j)
  float moment[kBlockPixels];            // d w / d sigma, times -sigma
};

void measure_geometry(const RingModel& model, const RingPixels& pixels, int first, BlockGeometry& g, RingBlock& block) {
  const auto value = [&](int i) { return static_cast<float>(model[i]); };
  const float cx = value(kCentreX), cy = value(kCentreY), w00 = value(kShape00), w10 = value(kShape10),
              w11 = value(kShape11), hx = value(kLineX), hy = value(kLineY);
  const float blur = value(kBlur), inverse_blur = 1.0F / blur;
  const float frobenius2 = w00 * w00 + w10 * w10 + w11 * w11;
  const float* x = pixels.x.data() + first;
  const float* y = pixels.y.data() + first;
  for (int i = 0; i < kBlockPixels; ++i) {
    const float dx = x[i] - cx, dy = y[i] - cy;
    const float u = w00 * dx, v = w10 * dx + w11 * dy;
    const float norm = std::sqrt(u * u + v * v + 1e-10F);
    const float inverse_norm = 1.0F / norm;
    const float inverse_line = 1.0F / (1.0F + hx * dx + hy * dy);
    const float a = u * inverse_norm, b = v * inverse_norm;
    const float r = norm * inverse_line;
    const float gx = (w00 * a + w10 * b - r * hx) * inverse_line;
    const float gy = (w11 * b - r * hy) * inverse_line;
    const float square = gx * gx + gy * gy;
    const float inverse_gradient = 1.0F / std::sqrt(square);
    // Second derivatives of r along the edge's normal n and in total, from those of |W d|.
    const float nx = gx * inverse_gradient, ny = gy * inverse_gradient;
    const float mx = w00 * a + w10 * b, my = w11 * b;
    const float wn0 = w00 * nx, wn1 = w10 * nx + w11 * ny;
    const float slope = mx * nx + my * ny;
    const float along_normal =
        inverse_line * ((wn0 * wn0 + wn1 * wn1 - slope * slope) * inverse_norm - 2.0F * slope * (hx * nx + hy * ny));
    const float laplacian =
        inverse_line * ((frobenius2 - mx * mx - my * my) * inverse_norm - 2.0F * (mx * hx + my * hy));
    const float bend = 0.5F * blur * along_normal * inverse_gradient;
    const float shift = 0.5F * blur * (laplacian - along_normal) * inverse_gradient;
    // Limits keep t monotonic, and the centre's own pixels finite.
    g.bend[i] = bend < -kMaxBend ? -kMaxBend : (bend > kMaxBend ? kMaxBend : bend);
    g.shift[i] = shift > kMaxShift ? kMaxShift : shift;
    g.dx[i] = dx;
    g.dy[i] = dy;
    g.inverse_line[i] = inverse_line;
    g.gradient_x[i] = gx;
    g.gradient_y[i] = gy;
    g.inverse_distance[i] = inverse_blur * inverse_gradient;
    block.direction_x[i] = a;
    block.direction_y[i] = b;
    block.radius[i] = r;
  }
}

struct Range {
  float low, high;
};

Range range_of(const float* value) {
  float low[4], high[4];
  for (int lane = 0; lane < 4; ++lane) low[lane] = high[lane] = value[lane];
  for (int i = 4; i < kBlockPixels; i += 4) {
    for (int lane = 0; lane < 4; ++lane) {
      low[lane] = value[i + lane] < low[lane] ? value[i + lane] : low[lane];
      high[lane] = value[i + lane] > high[lane] ? value[i + lane] : high[lane];
    }
  }
  return {std::min(std::min(low[0], low[1]), std::min(low[2], low[3])),
          std::max(std::max(high[0], high[1]), std::max(high[2], high[3]))};
}

// Adds one edge's blurred step; `radius_row` receives d w / d rho / (paper contrast) = -s phi / (|grad r| sigma).
void add_edge(float rho, float sign, const RingBlock& block, BlockGeometry& g, float* radius_row) {
  for (int i = 0; i < kBlockPixels; ++i) {
    float t0 = (block.radius[i] - rho) * g.inverse_distance[i];
    t0 = t0 < -kFarReach ? -kFarReach : t0;
    t0 = t0 > kFarReach ? kFarReach : t0;
    const float stretch = 1.0F + 2.0F * g.bend[i] * t0;
    float t = t0 * (1.0F + g.bend[i] * t0) + g.shift[i];
    t = t < -kEdgeReach ? -kEdgeReach : t;
    t = t > kEdgeReach ? kEdgeReach : t;
    const float q = t * t;
    const float step =
        t * (kStep[0] + q * (kStep[1] + q * (kStep[2] + q * (kStep[3] + q * (kStep[4] + q * kStep[5])))));
    const float density =
        sign * (kStep[0] +
                q * (3 * kStep[1] + q * (5 * kStep[2] + q * (7 * kStep[3] + q * (9 * kStep[4] + q * 11 * kStep[5])))));
    g.paper[i] += sign * (0.5F + step);
    g.density[i] += density * stretch;
    g.moment[i] += density * (t - 2.0F * g.shift[i]);  // t0 falls with the blur, the shift grows
    radius_row[i] = -density * stretch * g.inverse_distance[i];
  }
}

// Edges that the block meets get a row; those wholly to one side are a constant.
void add_edges(const RingModel& model, BlockGeometry& g, RingBlock& block) {
  const Range radius = range_of(block.radius);
  const float reach = kFarReach / range_of(g.inverse_distance).low;
  float constant = 1;
  std::fill_n(g.density, kBlockPixels, 0.0F);
  std::fill_n(g.moment, kBlockPixels, 0.0F);
  std::fill_n(g.paper, kBlockPixels, 0.0F);
  block.rows = kFirstRadius;
  for (int edge = 0; edge < model.edges(); ++edge) {
    const float rho = static_cast<float>(model.radius(edge));
    const float sign = edge % 2 == 0 ? 1.0F : -1.0F;
    if (rho > radius.high + reach) continue;
    if (rho < radius.low - reach) {
      constant += sign;
      continue;
    }
    // The outer radius is one by definition: its row is written and then overwritten by the next edge's.
    add_edge(rho, sign, block, g, block.row[block.rows]);
    if (edge == 0) continue;
    block.parameter[static_cast<std::size_t>(block.rows)] = kFirstRadius + edge - 1;
    ++block.rows;
  }
  for (float& paper : g.paper) paper += constant;
}

float weight_of(float grey, float predicted, float residual, float inverse_scale2) {
  const bool clipped = (grey >= 254.0F && predicted >= 250.0F) || (grey <= 1.0F && predicted <= 4.0F);
  const float spread = 1.0F + residual * residual * inverse_scale2;
  return clipped ? 0.0F : 1.0F / (spread * spread);
}

}  // namespace

ROOMCAL_VECTOR_CLONES void evaluate_block(const RingModel& model, const RingPixels& pixels, int first,
                                          const ResidualWeighting& weighting, RingBlock& block) {
  BlockGeometry g;
  measure_geometry(model, pixels, first, g, block);
  add_edges(model, g, block);
  const float l0 = static_cast<float>(model[kLight0]), lx = static_cast<float>(model[kLightX]),
              ly = static_cast<float>(model[kLightY]), ink = static_cast<float>(model[kInk]);
  const float inverse_blur = 1.0F / static_cast<float>(model[kBlur]);
  const float blur2 = static_cast<float>(model[kBlur] * model[kBlur]);
  const float inverse_scale2 = static_cast<float>(1.0 / (weighting.scale_grey * weighting.scale_grey));
  const float* x = pixels.x.data() + first;
  const float* y = pixels.y.data() + first;
  const float* grey = pixels.grey.data() + first;
  const int valid = std::min(kBlockPixels, pixels.count - first);
  alignas(64) float root_weight[kBlockPixels];
  alignas(64) float paper_light[kBlockPixels];
  alignas(64) float blurred_light[kBlockPixels];
  for (int i = 0; i < kBlockPixels; ++i) {
    const float light = l0 + lx * x[i] + ly * y[i];
    const float reflectance = ink + (1.0F - ink) * g.paper[i];
    // The blur acts on light times print: for affine light that adds sigma^2 grad(light) . grad(print), which moves
    // every edge the same way; without it the centre is off by sigma^2 |grad(light)| / light.
    const float print_slope = (1.0F - ink) * g.density[i] * g.inverse_distance[i];
    blurred_light[i] = blur2 * (lx * g.gradient_x[i] + ly * g.gradient_y[i]) * print_slope;
    const float predicted = light * reflectance + blurred_light[i];
    block.residual[i] = grey[i] - predicted;
    const float weight = weight_of(grey[i], predicted, block.residual[i], inverse_scale2);
    block.weight[i] = i < valid ? weight : 0.0F;
    paper_light[i] = light * (1.0F - ink);
    block.slope[i] = paper_light[i] * g.density[i] * g.inverse_distance[i];
  }
  for (int i = 0; i < kBlockPixels; ++i) root_weight[i] = std::sqrt(block.weight[i]);
  for (int i = 0; i < kBlockPixels; ++i) {
    const float slope = block.slope[i] * root_weight[i];
    const float over_line = slope * g.inverse_line[i];
    const float along = over_line * block.radius[i];
    const float light = l0 + lx * x[i] + ly * y[i];
    const float reflectance = (ink + (1.0F - ink) * g.paper[i]) * root_weight[i];
    block.row[kCentreX][i] = -slope * g.gradient_x[i];
    block.row[kCentreY][i] = -slope * g.gradient_y[i];
    block.row[kShape00][i] = over_line * block.direction_x[i] * g.dx[i];
    block.row[kShape10][i] = over_line * block.direction_y[i] * g.dx[i];
    block.row[kShape11][i] = over_line * block.direction_y[i] * g.dy[i];
    block.row[kLineX][i] = -along * g.dx[i];
    block.row[kLineY][i] = -along * g.dy[i];
    block.row[kLight0][i] = reflectance;
    block.row[kLightX][i] = reflectance * x[i];
    block.row[kLightY][i] = reflectance * y[i];
    block.row[kInk][i] = light * (1.0F - g.paper[i]) * root_weight[i];
    block.row[kBlur][i] = (blurred_light[i] - paper_light[i] * g.moment[i]) * inverse_blur * root_weight[i];
  }
  for (int i = 0; i < kFirstRadius; ++i) block.parameter[static_cast<std::size_t>(i)] = i;
  for (int row = kFirstRadius; row < block.rows; ++row) {
    for (int i = 0; i < kBlockPixels; ++i) block.row[row][i] *= paper_light[i] * root_weight[i];
  }
  for (int i = 0; i < kBlockPixels; ++i) block.row[block.rows][i] = block.residual[i] * root_weight[i];
  block.parameter[static_cast<std::size_t>(block.rows)] = kMaxParameters;
  ++block.rows;
  for (int row = block.rows; row < block.rows + RingBlock::kPadding; ++row)
    std::fill_n(block.row[row], kBlockPixels, 0.0F);
}

namespace {

// Eight floats on every architecture: the same sums everywhere.
constexpr int kLanes = 8;
using Lanes [[gnu::vector_size(kLanes * sizeof(float)), gnu::may_alias]] = float;

double total(const Lanes& lanes) {
  using Half [[gnu::vector_size(kLanes / 2 * sizeof(float))]] = float;
  const Half half = Half{lanes[0], lanes[1], lanes[2], lanes[3]} + Half{lanes[4], lanes[5], lanes[6], lanes[7]};
  return static_cast<double>((half[0] + half[1]) + (half[2] + half[3]));
}

const Lanes& lanes_at(const float* values) { return *reinterpret_cast<const Lanes*>(values); }

// Two sums side by side: one register where there are 16 floats in one, two where there are 8.
using LanePair [[gnu::vector_size(2 * kLanes * sizeof(float))]] = float;

// By reference: how a register that the processor may not have is returned is nobody's convention.
void put_side_by_side(const float* a, const float* b, LanePair& pair) {
  pair = __builtin_shufflevector(lanes_at(a), lanes_at(b), 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}

constexpr int kTileRows = 3, kTileColumns = 4;  // twelve sums held in registers

// Products of three rows with four others.
void multiply_tile(const float (*a)[kBlockPixels], const float (*b)[kBlockPixels],
                   double (&product)[kTileRows][kTileColumns]) {
  LanePair sum[kTileRows][2] = {};
  for (int i = 0; i < kBlockPixels; i += kLanes) {
    LanePair left, right[2];
    for (int n = 0; n < 2; ++n) put_side_by_side(b[2 * n] + i, b[2 * n + 1] + i, right[n]);
    for (int m = 0; m < kTileRows; ++m) {
      put_side_by_side(a[m] + i, a[m] + i, left);
      for (int n = 0; n < 2; ++n) sum[m][n] += left * right[n];
    }
  }
  for (int m = 0; m < kTileRows; ++m) {
    for (int n = 0; n < kTileColumns; ++n) {
      const LanePair& pair = sum[m][n / 2];
      const Lanes one = n % 2 == 0 ? __builtin_shufflevector(pair, pair, 0, 1, 2, 3, 4, 5, 6, 7)
                                   : __builtin_shufflevector(pair, pair, 8, 9, 10, 11, 12, 13, 14, 15);
      product[m][n] = total(one);
    }
  }
}

// The spread 1 + (e / scale)^2 is the weight's inverse square root, so nothing is divided here.
void sum_influence(const RingBlock& block, NormalEquations& equations) {
  alignas(64) float influence[kBlockPixels + kLanes] = {};
  alignas(64) float root[kBlockPixels];
  for (int i = 0; i < kBlockPixels; ++i) {
    influence[i] = block.weight[i] * block.residual[i];
    root[i] = std::sqrt(block.weight[i]);
  }
  Lanes cost = {}, weight = {}, influence2 = {}, slope = {}, neighbours = {};
  for (int i = 0; i < kBlockPixels; i += kLanes) {
    const Lanes w = lanes_at(block.weight + i), e = lanes_at(block.residual + i), q = lanes_at(root + i);
    const Lanes psi = lanes_at(influence + i);
    Lanes next;
    std::memcpy(&next, influence + i + 1, sizeof(next));
    cost += e * e * q;
    weight += w;
    influence2 += psi * psi;
    slope += w * (4.0F * q - 3.0F);
    neighbours += psi * next;
  }
  equations.cost += total(cost);
  equations.weight += total(weight);
  equations.influence2 += total(influence2);
  equations.slope += total(slope);
  equations.neighbours += total(neighbours);
}

}  // namespace

ROOMCAL_VECTOR_CLONES void accumulate(const RingBlock& block, NormalEquations& equations) {
  for (int a = 0; a < block.rows; a += kTileRows) {
    for (int b = a - a % kTileColumns; b < block.rows; b += kTileColumns) {
      double product[kTileRows][kTileColumns];
      multiply_tile(&block.row[a], &block.row[b], product);
      for (int m = 0; m < kTileRows && a + m < block.rows; ++m) {
        for (int n = 0; n < kTileColumns && b + n < block.rows; ++n) {
          if (b + n < a + m) continue;
          const auto i = static_cast<std::size_t>(block.parameter[static_cast<std::size_t>(a + m)]);
          const auto j = static_cast<std::size_t>(block.parameter[static_cast<std::size_t>(b + n)]);
          equations.sum[i][j] += product[m][n];
        }
      }
    }
  }
  sum_influence(block, equations);
}

}  // namespace roomcal::marker
