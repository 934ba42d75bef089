#include "tools/bake/bundle_cost.h"

#include <algorithm>

namespace roomcal::tools {

namespace {

using RowMat33 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
template <int M, int N>
using RowMap = Eigen::Map<Eigen::Matrix<double, M, N, N == 1 ? Eigen::ColMajor : Eigen::RowMajor>>;

/// Six tangent columns in front, six columns of nothing.
template <int M>
void set_pose_jacobian(double* jacobian, const Eigen::Matrix<double, M, 6>& J) {
  RowMap<M, 12> out(jacobian);
  out.setZero();
  out.template leftCols<6>() = J;
}

}  // namespace

PoseBlock::PoseBlock(const SE3& T) {
  Eigen::Map<RowMat33>(x.data()) = T.R;
  Eigen::Map<Vec3>(x.data() + 9) = T.t;
}

SE3 PoseBlock::to_pose(const double* x) { return {Eigen::Map<const RowMat33>(x), Eigen::Map<const Vec3>(x + 9)}; }

bool PoseManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  SE3 T = PoseBlock::to_pose(x) * se3_exp(Eigen::Map<const Vec6>(delta));
  T.R = nearest_rotation(T.R);
  const PoseBlock block(T);
  std::copy(block.x.begin(), block.x.end(), x_plus_delta);
  return true;
}

bool PoseManifold::PlusJacobian(const double*, double* jacobian) const {
  RowMap<12, 6> J(jacobian);
  J.setZero();
  J.topRows<6>().setIdentity();
  return true;
}

bool PoseManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  Eigen::Map<Vec6>{y_minus_x} = se3_log(PoseBlock::to_pose(x).inverse() * PoseBlock::to_pose(y));
  return true;
}

bool PoseManifold::MinusJacobian(const double*, double* jacobian) const {
  RowMap<6, 12> J(jacobian);
  J.setZero();
  J.leftCols<6>().setIdentity();
  return true;
}

std::array<double, camera::kIntrinsicsCount> to_values(const camera::Intrinsics& k) {
  return {k.fx_px, k.fy_px, k.cx_px, k.cy_px, k.distortion[0], k.distortion[1], k.distortion[2], k.distortion[3]};
}

camera::Intrinsics with_values(camera::Intrinsics intrinsics, const double* values) {
  intrinsics.fx_px = values[0];
  intrinsics.fy_px = values[1];
  intrinsics.cx_px = values[2];
  intrinsics.cy_px = values[3];
  std::copy_n(values + 4, camera::kDistortionCount, intrinsics.distortion.begin());
  return intrinsics;
}

RigBlocks::RigBlocks(const StereoRig& rig) : rig_(rig), T_side_left_{PoseBlock(), PoseBlock(rig.T_right_left)} {
  for (const Side side : kBothSides) intrinsics_[side] = to_values(rig.cameras[side].intrinsics());
}

void RigBlocks::PrepareForEvaluation(bool, bool new_evaluation_point) {
  if (new_evaluation_point) rebuild();
}

void RigBlocks::rebuild() {
  valid_ = true;
  for (const Side side : kBothSides) {
    if (intrinsics_[side] == to_values(rig_.cameras[side].intrinsics())) continue;
    const auto camera = camera::Camera::create(with_values(rig_.cameras[side].intrinsics(), intrinsics_[side].data()));
    valid_ = valid_ && camera.ok();
    if (camera.ok()) rig_.cameras[side] = camera.value();
  }
}

StereoRig RigBlocks::rig() {
  rebuild();
  rig_.T_right_left = T_side_left_[kRight].pose();
  return rig_;
}

bool ReprojectionCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  if (!rig_.valid()) return false;
  const SE3 T_room_left = PoseBlock::to_pose(parameters[0]);
  const SE3 T_side_left = PoseBlock::to_pose(parameters[2]);
  const Vec3 p_left = T_room_left.R.transpose() * (Eigen::Map<const Vec3>(parameters[1]) - T_room_left.t);
  camera::ProjectJacobians J;
  Vec2 px;
  const bool seen = rig_.camera(side_).project(T_side_left * p_left, px, &J).ok();
  // A point that a step has put behind the camera costs as much as the robust loss lets any point cost.
  constexpr double kLost = 1e3;
  const Vec2 residual = seen ? Vec2(whitening_ * (px - px_)) : Vec2(kLost, kLost);
  std::copy_n(residual.data(), 2, residuals);
  if (jacobians == nullptr) return true;
  const Mat23 J_side = seen ? Mat23(whitening_ * J.J_point) : Mat23::Zero();
  const Mat23 J_left = J_side * T_side_left.R;
  if (jacobians[0] != nullptr) {
    Mat26 J_pose;
    J_pose << -J_left, J_left * hat(p_left);
    set_pose_jacobian<2>(jacobians[0], J_pose);
  }
  if (jacobians[1] != nullptr) RowMap<2, 3>{jacobians[1]} = J_left * T_room_left.R.transpose();
  if (jacobians[2] != nullptr) {
    Mat26 J_pose;
    J_pose << J_left, -J_left * hat(p_left);
    set_pose_jacobian<2>(jacobians[2], J_pose);
  }
  if (jacobians[3] != nullptr) {
    RowMap<2, camera::kIntrinsicsCount> out(jacobians[3]);
    out.setZero();
    if (seen) out = whitening_ * J.J_intrinsics;
  }
  return true;
}

bool RigPriorCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const SE3 T = PoseBlock::to_pose(parameters[0]);
  // Offset of t in the right camera's axes, and rotation: (t - t_given, log(R_given^T R)).
  Vec6 off;
  off.head<3>() = T.t - given_.t;
  off.tail<3>() = so3_log(given_.R.transpose() * T.R);
  Eigen::Map<Vec6>{residuals} = whitening_ * off;
  if (jacobians == nullptr || jacobians[0] == nullptr) return true;
  Mat66 J = Mat66::Zero();
  J.topLeftCorner<3, 3>() = T.R;
  J.bottomRightCorner<3, 3>() = so3_right_jacobian_inverse(off.tail<3>());
  set_pose_jacobian<6>(jacobians[0], whitening_ * J);
  return true;
}

bool IntrinsicsPriorCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const double* x = parameters[0];
  for (std::size_t i = 0; i < given_.size(); ++i) residuals[i] = (x[i] - given_[i]) / sigma_[i];
  residuals[1] = (x[1] / x[0] - given_[1] / given_[0]) / sigma_[1];
  if (jacobians == nullptr || jacobians[0] == nullptr) return true;
  RowMap<camera::kIntrinsicsCount, camera::kIntrinsicsCount> J(jacobians[0]);
  J.setZero();
  for (std::size_t i = 0; i < sigma_.size(); ++i) J(static_cast<int>(i), static_cast<int>(i)) = 1 / sigma_[i];
  J(1, 0) = -x[1] / (x[0] * x[0]) / sigma_[1];
  J(1, 1) = 1 / x[0] / sigma_[1];
  return true;
}

}  // namespace roomcal::tools
