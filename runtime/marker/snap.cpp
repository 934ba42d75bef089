#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "runtime/marker/profile.h"

namespace roomcal::marker {
namespace {

constexpr int kRays = PolarGrid::kRays;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

struct EdgePoint {
  Vec2 z = Vec2::Zero();  // in the grid's frame: |z| is about 1
  double weight = 0;
};

struct EdgePoints {
  std::array<EdgePoint, kRays> ray{};
  int visible = 0;
};

// The rise outwards nearest to rho = 1, among those at least half as steep as the ray's steepest. Nearest rather than
// steepest: the next ring's outer edge, 0.2 away or more, is just as steep.
bool find_edge(const PolarGrid& grid, int ray, double window, double& rho) {
  const auto& level = grid.level[at(ray)];
  window = std::max(window, 1.2 / grid.A.col(0).norm());  // a pixel and a bit
  // Differences over 0.6 px or a thirtieth of the radius: noise must not make edges of its own in a blurred marker.
  const double half_rho = std::max(0.6 / grid.A.col(0).norm(), 0.033);
  const int reach = std::max(1, static_cast<int>(std::lround(half_rho / grid.spacing)));
  const int first = std::max(reach, static_cast<int>(grid.sample(1 - window)));
  const int last = std::min(grid.samples - 1 - reach, static_cast<int>(std::ceil(grid.sample(1 + window))));
  std::array<float, PolarGrid::kMaxSamples> rise;
  const int from = std::max(first - 1, reach), to = std::min(last + 1, grid.samples - 1 - reach);
  for (int j = from; j <= to; ++j) rise[at(j)] = level[at(j + reach)] - level[at(j - reach)];
  float steepest = 6;  // grey levels: below lies noise
  for (int j = first; j <= last; ++j) steepest = std::max(steepest, rise[at(j)]);
  double best_distance = 1e9;
  for (int j = std::max(first, from + 1); j <= std::min(last, to - 1); ++j) {
    const float here = rise[at(j)], before = rise[at(j - 1)], after = rise[at(j + 1)];
    if (here < 0.5F * steepest || here < before || here <= after) continue;
    const float curvature = before - 2 * here + after;
    const double shift = curvature < -1e-6F ? static_cast<double>(0.5F * (before - after) / curvature) : 0;
    const double candidate = grid.radius(j + shift);
    if (std::fabs(candidate - 1) > best_distance) continue;
    best_distance = std::fabs(candidate - 1);
    rho = candidate;
  }
  return best_distance < 1e9;
}

void collect_edges(const PolarGrid& grid, double window, EdgePoints& points) {
  const int needed = std::min(grid.samples - 1, static_cast<int>(std::ceil(grid.sample(1 + window))));
  for (int ray = 0; ray < kRays; ++ray) {
    if (grid.level[at(ray)][at(needed)] < 0) continue;
    ++points.visible;
    double rho = 0;
    if (!find_edge(grid, ray, window, rho)) continue;
    points.ray[at(ray)] = {rho * grid.direction[at(ray)], 1.0};
  }
}

// Near-circle in the grid's frame:  q0 x^2 + q1 x y + q2 y^2 + q3 x + q4 y = 1.
using Conic = Eigen::Matrix<double, 5, 1>;
using Terms = std::array<double, 5>;

Terms terms(const Vec2& z) { return {z.x() * z.x(), z.x() * z.y(), z.y() * z.y(), z.x(), z.y()}; }

// Distance from the conic in units of rho, first order: the gradient of the form on a unit circle is about 2.
double distance_from(const Conic& conic, const Terms& row) {
  double form = -1;
  for (int i = 0; i < 5; ++i) form += row[at(i)] * conic[i];
  return form / 2;
}

Conic weighted_conic(const std::array<Terms, kRays>& rows, const EdgePoints& points) {
  // Drawn weakly towards the unit circle, so that a border-cut marker keeps a sane ellipse on its missing side.
  constexpr double kPrior = 0.02;
  double sum[5][5] = {}, target[5] = {kPrior, 0, kPrior, 0, 0};
  for (int i = 0; i < 5; ++i) sum[i][i] = kPrior;
  for (int ray = 0; ray < kRays; ++ray) {
    const Terms& row = rows[at(ray)];
    for (int i = 0; i < 5; ++i) {
      const double weighted = points.ray[at(ray)].weight * row[at(i)];
      for (int j = 0; j <= i; ++j) sum[i][j] += weighted * row[at(j)];
      target[i] += weighted;
    }
  }
  Eigen::Matrix<double, 5, 5> normal;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j <= i; ++j) normal(i, j) = normal(j, i) = sum[i][j];
  }
  return normal.ldlt().solve(Eigen::Map<const Conic>(target));
}

// Re-weighted least squares with a scale that shrinks down to `floor`. @return weight of the points that agree, in
// points.
double fit_conic(EdgePoints& points, double window, double floor, Conic& conic) {
  std::array<Terms, kRays> rows;
  std::array<bool, kRays> found;
  for (int i = 0; i < kRays; ++i) {
    rows[at(i)] = terms(points.ray[at(i)].z);
    found[at(i)] = points.ray[at(i)].weight > 0;
  }
  double scale = window / 2, total = 0;
  for (int round = 0; round < 5; ++round) {
    conic = weighted_conic(rows, points);
    total = 0;
    for (int i = 0; i < kRays; ++i) {
      if (!found[at(i)]) continue;
      const double error = distance_from(conic, rows[at(i)]) / scale;
      const double spread = 1 + error * error;
      points.ray[at(i)].weight = 1 / (spread * spread);
      total += points.ray[at(i)].weight;
    }
    scale = std::max(0.6 * scale, floor);
  }
  return total;
}

bool to_ellipse(const PolarGrid& grid, const Conic& conic, Ellipse& ellipse) {
  Mat22 Q;
  Q << conic[0], conic[1] / 2, conic[1] / 2, conic[2];
  const double determinant = Q.determinant();
  if (!(determinant > 0.05)) return false;
  const Vec2 z0 = -0.5 * Q.inverse() * conic.tail<2>();
  const double k = 1 + z0.dot(Q * z0);
  // p = centre + A (z0 + e), e^T (Q / k) e = 1: shape of the ellipse in the image is A^-T (Q / k) A^-1.
  const Mat22 A_inverse = grid.A.inverse();
  const Mat22 M = A_inverse.transpose() * (Q / k) * A_inverse;
  const double trace = M.trace(), spread = std::hypot(M(0, 0) - M(1, 1), 2 * M(0, 1));
  if (!(trace - spread > 0)) return false;
  ellipse.centre_px = grid.centre_px + grid.A * z0;
  ellipse.major_px = 2 / std::sqrt((trace - spread) / 2);
  ellipse.minor_px = 2 / std::sqrt((trace + spread) / 2);
  ellipse.angle_rad = 0.5 * std::atan2(-2 * M(0, 1), M(1, 1) - M(0, 0));
  return true;
}

}  // namespace

Status snap_to_outer_edge(const PolarGrid& grid, double window, Ellipse& ellipse, double& support) {
  EdgePoints points;
  collect_edges(grid, window, points);
  support = 0;
  Conic conic;
  // Edge points are good to a few tenths of a pixel where blur has merged the rings.
  const double floor = std::max(0.03, 0.35 / grid.A.col(1).norm());
  const double agreeing = fit_conic(points, std::max(window, 2 * floor), floor, conic);
  if (agreeing < kRays / 4) return {StatusCode::kNotFound, "no closed dark-to-light edge"};
  Ellipse fitted;
  if (!to_ellipse(grid, conic, fitted)) return {StatusCode::kNotFound, "the edge is no ellipse"};
  ellipse = fitted;
  support = agreeing / points.visible;
  return ok_status();
}

}  // namespace roomcal::marker
