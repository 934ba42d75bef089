#include "runtime/rig/plane_terms.h"

#include <algorithm>

#include <Eigen/Cholesky>

#include "runtime/math/dense_ldlt.h"
#include "runtime/rig/joint_problem.h"
#include "runtime/rig/normal_equations.h"

namespace roomcal::rig {

namespace {

using Block = Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>, 0, Eigen::OuterStride<>>;

Block block(std::span<double> M, std::size_t size, std::size_t row, std::size_t col) {
  return Block(&M[6 * row * size + 6 * col], Eigen::OuterStride<>(static_cast<Eigen::Index>(size)));
}

bool may_be_off(const RigInput& input, const PlanePull& pull) {
  return pull.plane < input.plane_cov.size() && !input.plane_cov[pull.plane].isZero(0);
}

std::size_t count_gains(const RigInput& input) {
  std::size_t count = 0;
  for (const LidarView& lidar : input.lidars)
    count += static_cast<std::size_t>(std::count_if(lidar.pulls.begin(), lidar.pulls.end(),
                                                    [&](const PlanePull& pull) { return may_be_off(input, pull); }));
  return count;
}

/// Estimates of single LiDARs, their gains, and what their own noise leaves of them.
void fill_alone(const RigInput& input, std::span<double> cov, LidarsOnPlanes& planes) {
  const std::size_t size = 6 * input.lidars.size();
  std::size_t next = 0;
  for (std::size_t l = 0; l < input.lidars.size(); ++l) {
    const LidarView& lidar = input.lidars[l];
    const Eigen::LDLT<Mat66> own(own_information(lidar));
    block(cov, size, l, l) = own.solve(Mat66::Identity());
    Eigen::Map<Vec6>(&planes.estimate[6 * l]) = own.solve(lidar.points.gradient);
    for (const PlanePull& pull : lidar.pulls)
      if (may_be_off(input, pull)) planes.gains[next++] = {l, pull.plane, own.solve(pull.pull)};
  }
}

void add_planes(std::span<const Mat33> plane_cov, const LidarsOnPlanes& planes, std::size_t size,
                std::span<double> cov) {
  for (const PlaneGain& a : planes.gains)
    for (const PlaneGain& b : planes.gains)
      if (a.plane == b.plane && b.lidar <= a.lidar)  // the lower blocks suffice
        block(cov, size, a.lidar, b.lidar) += a.gain * plane_cov[a.plane] * b.gain.transpose();
}

}  // namespace

Status LidarsOnPlanes::build(const RigInput& input, Arena& scratch, LidarsOnPlanes& planes) {
  const std::size_t count = count_gains(input), size = 6 * input.lidars.size();
  if (count == 0) return ok_status();
  planes.information = scratch.allocate<double>(size * size);
  planes.estimate = scratch.allocate<double>(size);
  planes.gains = scratch.allocate<PlaneGain>(count);
  const std::span<double> cov = scratch.allocate<double>(size * size);
  if (planes.information.empty() || planes.estimate.empty() || planes.gains.empty() || cov.empty())
    return out_of_arena("scratch arena: no room for the planes' errors: reserve solve_scratch_bytes()");
  fill_alone(input, cov, planes);
  add_planes(input.plane_cov, planes, size, cov);
  ROOMCAL_TRY(ldlt_factor(cov, size));
  ldlt_inverse(cov, size, planes.information);
  return ok_status();
}

std::size_t LidarsOnPlanes::bytes(std::size_t lidars) {
  const std::size_t size = 6 * lidars;
  return (2 * size * size + size) * sizeof(double) + lidars * kMaxPulls * sizeof(PlaneGain) +
         4 * alignof(std::max_align_t);
}

Mat66 LidarsOnPlanes::information_block(std::size_t a, std::size_t b) const {
  return block(information, estimate.size(), a, b);
}

Vec6 LidarsOnPlanes::estimate_of(std::size_t lidar) const { return Eigen::Map<const Vec6>(&estimate[6 * lidar]); }

Mat66 own_information(const LidarView& lidar) {
  Mat66 own = lidar.points.information;
  own.diagonal().head<3>().array() += 1 / (lidar.open_sigma_t_m * lidar.open_sigma_t_m);
  own.diagonal().tail<3>().array() += 1 / (lidar.open_sigma_rot_rad * lidar.open_sigma_rot_rad);
  return own;
}

namespace {

/// Three columns, one row for every unknown of the normal equations.
using Rows = std::span<Eigen::RowVector3d>;

/// sum_i B_i C_i^-1 N_i^T over the markers of a plane that are seen.
void fill_markers(const JointProblem& problem, const NormalEquations& equations, std::size_t plane, Rows rows) {
  std::fill(rows.begin(), rows.end(), Eigen::RowVector3d(0, 0, 0));
  for (std::size_t l = 0; l < problem.landmarks.size(); ++l) {
    const LandmarkTerms& landmark = problem.landmarks[l];
    if (problem.given[l].plane != plane || landmark.exact || landmark.count == 0) continue;
    const Mat33 V = landmark.C_inv * landmark.L.transpose() * problem.given[l].plane_by_point.transpose();
    for (const uint32_t i : problem.by_landmark.subspan(landmark.first, landmark.count)) {
      const Term& term = problem.terms[i];
      if (term.weight == 0) continue;
      const Mat23 J_V = term.weight * term.J_u * V;
      for (std::size_t k = 0; k < 6; ++k)
        rows[6 * term.view + k] += term.J_pose.col(static_cast<Eigen::Index>(k)).transpose() * J_V;
      const std::size_t lens = problem.views[term.view].lens;
      for (std::size_t k = 0; lens != kHeldLens && k < camera::kIntrinsicsCount; ++k)
        rows[equations.lens_offset(lens) + k] += problem.J_lens[i].col(static_cast<Eigen::Index>(k)).transpose() * J_V;
    }
  }
}

/// Z_p: what a plane's error adds to the gradient of the LiDARs' poses.
void fill_lidars(const JointProblem& problem, std::size_t plane, Rows rows) {
  std::fill(rows.begin(), rows.end(), Eigen::RowVector3d(0, 0, 0));
  for (std::size_t l = 0; l < problem.lidars.size(); ++l) {
    const std::size_t sensor = problem.views.size() + l;
    const Vec6 xi = se3_log(problem.lidars[l].points.T_hat.inverse() * problem.state.T_room_sensor[sensor]);
    Mat63 Z = Mat63::Zero();
    for (const PlaneGain& gain : problem.planes.gains)
      if (gain.plane == plane) Z += problem.planes.information_block(l, gain.lidar) * gain.gain;
    Z = se3_right_jacobian_inverse(xi).transpose() * Z;
    for (std::size_t k = 0; k < 6; ++k) rows[6 * sensor + k] = Z.row(static_cast<Eigen::Index>(k));
  }
}

/// out = M in, M square.
void multiply(std::span<const double> M, Rows in, Rows out) {
  for (std::size_t r = 0; r < in.size(); ++r) {
    out[r].setZero();
    for (std::size_t c = 0; c < in.size(); ++c) out[r] += M[r * in.size() + c] * in[c];
  }
}

}  // namespace

Status correlate_planes_with_markers(const JointProblem& problem, NormalEquations& equations, Arena& scratch,
                                     std::span<double> cov) {
  if (!problem.planes.used()) return ok_status();
  const std::size_t n = equations.size;
  const Rows markers = scratch.allocate<Eigen::RowVector3d>(n), lidars = scratch.allocate<Eigen::RowVector3d>(n),
             left = scratch.allocate<Eigen::RowVector3d>(n), right = scratch.allocate<Eigen::RowVector3d>(n);
  if (markers.empty() || lidars.empty() || left.empty() || right.empty())
    return out_of_arena("scratch arena: no room for the planes' errors: reserve solve_scratch_bytes()");
  std::fill(equations.S.begin(), equations.S.end(), 0.0);
  for (std::size_t plane = 0; plane < problem.plane_cov.size(); ++plane) {
    const auto of_plane = [&](const PlaneGain& gain) { return gain.plane == plane; };
    if (std::none_of(problem.planes.gains.begin(), problem.planes.gains.end(), of_plane)) continue;
    fill_markers(problem, equations, plane, markers);
    fill_lidars(problem, plane, lidars);
    multiply(cov, markers, left);
    multiply(cov, lidars, right);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) equations.S[i * n + j] += left[i].dot(right[j]);
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) cov[i * n + j] += equations.S[i * n + j] + equations.S[j * n + i];
  return ok_status();
}

std::size_t correlation_bytes(std::size_t unknowns) {
  return 4 * (unknowns * sizeof(Eigen::RowVector3d) + alignof(Eigen::RowVector3d));
}

}  // namespace roomcal::rig
