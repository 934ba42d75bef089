#include "runtime/rig/lidar_terms.h"

#include <array>

#include <Eigen/Core>

namespace roomcal::rig {

namespace {

using Block = Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>, 0, Eigen::OuterStride<>>;

Vec6 weights(double sigma_t_m, double sigma_rot_rad) {
  Vec6 w;
  w.head<3>().setConstant(1 / (sigma_t_m * sigma_t_m));
  w.tail<3>().setConstant(1 / (sigma_rot_rad * sigma_rot_rad));
  return w;
}

/// Where a LiDAR stands against what its points and its mount say.
struct Residuals {
  Vec6 points;            ///< log(T_hat^-1 T_room_lidar)
  Vec6 mount;             ///< log(T_lidar_reference T_room_reference^-1 T_room_lidar)
  SE3 T_lidar_reference;  ///< at the state
  bool mounted = false;
};

Residuals residuals(const JointProblem& problem, const State& at, std::size_t i) {
  const LidarView& lidar = problem.lidars[i];
  const SE3& T_room_lidar = at.T_room_sensor[problem.views.size() + i];
  Residuals r;
  r.points = se3_log(lidar.points.T_hat.inverse() * T_room_lidar);
  r.mounted = lidar.mount.known && problem.reference != kNoReference;
  if (!r.mounted) return r;
  const SE3 T_reference_lidar = at.T_room_sensor[problem.reference].inverse() * T_room_lidar;
  r.T_lidar_reference = T_reference_lidar.inverse();
  r.mount = se3_log(lidar.mount.T_reference_lidar.inverse() * T_reference_lidar);
  return r;
}

/// J_row' w J_col and J_row' w r of one residual, into the blocks of two sensors.
void add_block(std::size_t row, std::size_t col, const Mat66& H, NormalEquations& equations) {
  Block(&equations.S[6 * row * equations.size + 6 * col],
        Eigen::OuterStride<>(static_cast<Eigen::Index>(equations.size))) += H;
}

void add_gradient(std::size_t sensor, const Vec6& g, NormalEquations& equations) {
  Eigen::Map<Vec6>(&equations.gradient[6 * sensor]) += g;
}

void add_points(const LidarView& lidar, const Vec6& xi, std::size_t sensor, NormalEquations& equations) {
  const Mat66 J = se3_right_jacobian_inverse(xi), own = own_information(lidar);
  add_block(sensor, sensor, J.transpose() * own * J, equations);
  add_gradient(sensor, J.transpose() * (own * xi - lidar.points.gradient), equations);
}

/// The same for all LiDARs together, where they share planes that may be off.
void add_points_together(const JointProblem& problem, NormalEquations& equations) {
  const LidarsOnPlanes& planes = problem.planes;
  std::array<Mat66, kMaxLidars> J;
  std::array<Vec6, kMaxLidars> off;
  for (std::size_t l = 0; l < problem.lidars.size(); ++l) {
    const Vec6 xi = residuals(problem, problem.state, l).points;
    J[l] = se3_right_jacobian_inverse(xi);
    off[l] = xi - planes.estimate_of(l);
  }
  for (std::size_t l = 0; l < problem.lidars.size(); ++l) {
    const std::size_t sensor = problem.views.size() + l;
    Vec6 g = Vec6::Zero();
    for (std::size_t m = 0; m < problem.lidars.size(); ++m) {
      const Mat66 own = planes.information_block(l, m);
      g += own * off[m];
      if (m <= l) add_block(sensor, problem.views.size() + m, J[l].transpose() * own * J[m], equations);
    }
    add_gradient(sensor, J[l].transpose() * g, equations);
  }
}

double cost_together(const JointProblem& problem, const State& at) {
  double sum = 0;
  for (std::size_t l = 0; l < problem.lidars.size(); ++l) {
    const Vec6 off = residuals(problem, at, l).points - problem.planes.estimate_of(l);
    for (std::size_t m = 0; m < problem.lidars.size(); ++m)
      sum += off.dot(problem.planes.information_block(l, m) *
                     (residuals(problem, at, m).points - problem.planes.estimate_of(m)));
  }
  return sum;
}

void add_mount(const LidarMount& mount, const Residuals& r, std::size_t sensor, std::size_t reference,
               NormalEquations& equations) {
  const Vec6 w = weights(mount.sigma_t_m, mount.sigma_rot_rad);
  // (T_reference exp(d))^-1 T_lidar = T_reference_lidar exp(-Ad(T_lidar_reference) d).
  const Mat66 J_lidar = se3_right_jacobian_inverse(r.mount);
  const Mat66 J_reference = -J_lidar * se3_adjoint(r.T_lidar_reference);
  const Mat66 weighted = w.asDiagonal() * J_lidar, weighted_reference = w.asDiagonal() * J_reference;
  add_block(sensor, sensor, J_lidar.transpose() * weighted, equations);
  add_block(sensor, reference, J_lidar.transpose() * weighted_reference, equations);  // lower: cameras come first
  add_block(reference, reference, J_reference.transpose() * weighted_reference, equations);
  add_gradient(sensor, weighted.transpose() * r.mount, equations);
  add_gradient(reference, weighted_reference.transpose() * r.mount, equations);
}

}  // namespace

double lidar_cost(const JointProblem& problem, const State& at) {
  double sum = problem.planes.used() ? cost_together(problem, at) : 0;
  for (std::size_t i = 0; i < problem.lidars.size(); ++i) {
    const LidarView& lidar = problem.lidars[i];
    const Residuals r = residuals(problem, at, i);
    if (!problem.planes.used())
      sum += r.points.dot(own_information(lidar) * r.points) - 2 * lidar.points.gradient.dot(r.points);
    if (!r.mounted) continue;
    const Vec6 w = weights(lidar.mount.sigma_t_m, lidar.mount.sigma_rot_rad);
    sum += r.mount.cwiseAbs2().dot(w);
  }
  return sum;
}

void add_lidars(const JointProblem& problem, NormalEquations& equations) {
  if (problem.planes.used()) add_points_together(problem, equations);
  for (std::size_t i = 0; i < problem.lidars.size(); ++i) {
    const std::size_t sensor = problem.views.size() + i;
    const Residuals r = residuals(problem, problem.state, i);
    if (!problem.planes.used()) add_points(problem.lidars[i], r.points, sensor, equations);
    if (r.mounted) add_mount(problem.lidars[i].mount, r, sensor, problem.reference, equations);
  }
}

}  // namespace roomcal::rig
