#include <cmath>
#include <functional>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "tests/truth/marker_patch.h"

namespace roomcal::truth {
namespace {

using Perturb = std::function<void(MarkerPatch&, double)>;

struct Direction {
  Perturb move;
  double step;
};

// A generator on the plane's side: H_px_plane (I + step E). Only the first two move the centre.
Direction plane_direction(int row, int column, bool symmetric, double step) {
  return {[=](MarkerPatch& patch, double amount) {
            Mat33 E = Mat33::Zero();
            E(row, column) = 1;
            if (symmetric) E(column, row) = 1;
            patch.H_px_plane = patch.H_px_plane * (Mat33::Identity() + amount * E);
          },
          step};
}

std::vector<Direction> unknowns(const MarkerPatch& patch, Unknown unknown) {
  // A tenth of a pixel: large against the supersampling's grain, small against the blur.
  const double step = 0.2 / patch.diameter_px;
  std::vector<Direction> list{
      plane_direction(0, 2, false, step), plane_direction(1, 2, false, step), plane_direction(0, 0, false, step),
      plane_direction(1, 1, false, step), plane_direction(0, 1, true, step),  plane_direction(2, 0, false, step),
      plane_direction(2, 1, false, step),
  };
  list.push_back({[](MarkerPatch& p, double amount) {
                    p.paper += amount;
                    p.ink += amount * p.ink / p.paper;
                  },
                  1});
  list.push_back({[](MarkerPatch& p, double amount) { p.ink += amount; }, 1});
  list.push_back({[](MarkerPatch& p, double amount) { p.light_gradient.x() += amount; }, 0.01});
  list.push_back({[](MarkerPatch& p, double amount) { p.light_gradient.y() += amount; }, 0.01});
  if (unknown == Unknown::kNothingElse) return list;
  list.push_back({[](MarkerPatch& p, double amount) { p.blur_px += amount; }, 0.02});
  for (std::size_t i = 1; i < patch.radii.size(); ++i) {
    list.push_back({[i](MarkerPatch& p, double amount) { p.radii[i] += amount; }, step});
  }
  return list;
}

std::vector<double> derivative(const MarkerPatch& patch, const Direction& direction) {
  MarkerPatch plus = patch, minus = patch;
  direction.move(plus, direction.step);
  direction.move(minus, -direction.step);
  std::vector<double> result = render_clean(plus);
  const std::vector<double> low = render_clean(minus);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = (result[i] - low[i]) / (2 * direction.step);
  return result;
}

}  // namespace

Mat22 cramer_rao_bound(const MarkerPatch& sheet, Unknown unknown) {
  // The bound is of the rings: the sheet's edge moves with them, but nobody knows where it is.
  MarkerPatch patch = sheet;
  patch.sheet_half_x = patch.sheet_half_y = 1e3;
  std::vector<std::vector<double>> column;
  for (const Direction& direction : unknowns(patch, unknown)) column.push_back(derivative(patch, direction));
  const Mat33 H_plane_px = patch.H_px_plane.inverse();
  const auto n = static_cast<Eigen::Index>(column.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  for (int y = 0; y < patch.height; ++y) {
    for (int x = 0; x < patch.width; ++x) {
      const Vec3 q = H_plane_px * Vec3{static_cast<double>(x), static_cast<double>(y), 1};
      if ((q.head<2>() / q.z()).norm() > 1.15) continue;
      Eigen::VectorXd row(n);
      for (Eigen::Index i = 0; i < n; ++i) {
        row[i] = column[static_cast<std::size_t>(i)][static_cast<std::size_t>(y * patch.width + x)];
      }
      information += row * row.transpose();
    }
  }
  information /= patch.noise_grey * patch.noise_grey + 1.0 / 12;
  const Mat22 plane_covariance = information.ldlt().solve(Eigen::MatrixXd::Identity(n, n)).topLeftCorner<2, 2>();
  // d pixel / d plane point at the centre.
  const Mat33& H = patch.H_px_plane;
  const Mat22 J = (H.topLeftCorner<2, 2>() - patch.centre_px() * H.row(2).head<2>()) / H(2, 2);
  return J * plane_covariance * J.transpose();
}

}  // namespace roomcal::truth
