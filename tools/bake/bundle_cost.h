#pragma once

#include <array>
#include <memory>

#include <ceres/ceres.h>

#include "tools/bake/survey.h"

namespace roomcal::tools {

/// An SE3 as Ceres sees it: R by rows, then t. Its tangent is ours (right perturbation, translation first).
///
/// Cost functions put the derivative in the tangent into the first six of the twelve ambient columns and the manifold's
/// Plus Jacobian picks these, so no derivative in a rotation matrix's nine numbers is ever formed.
struct PoseBlock {
  std::array<double, 12> x;

  PoseBlock() : PoseBlock(SE3{}) {}
  explicit PoseBlock(const SE3& T);
  SE3 pose() const { return to_pose(x.data()); }
  static SE3 to_pose(const double* x);
};

class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 12; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

/// The two cameras as parameters; cameras are made anew once per evaluation, not once per measurement.
class RigBlocks final : public ceres::EvaluationCallback {
 public:
  explicit RigBlocks(const StereoRig& rig);
  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override;

  const camera::Camera& camera(Side side) const { return rig_.cameras[side]; }
  double* intrinsics(Side side) { return intrinsics_[side].data(); }
  /// T_<side>_left; of the left camera the identity.
  double* T_side_left(Side side) { return T_side_left_[side].x.data(); }
  bool valid() const { return valid_; }
  /// The rig of the parameters' present values.
  StereoRig rig();

 private:
  void rebuild();

  StereoRig rig_;
  std::array<std::array<double, camera::kIntrinsicsCount>, 2> intrinsics_;
  std::array<PoseBlock, 2> T_side_left_;
  bool valid_ = true;  ///< false while the intrinsics tried make no camera
};

/// Whitened reprojection error of one sighting; parameters T_room_left, p_room, T_side_left, intrinsics.
class ReprojectionCost final : public ceres::SizedCostFunction<2, 12, 3, 12, camera::kIntrinsicsCount> {
 public:
  ReprojectionCost(const RigBlocks& rig, Side side, const Vec2& px, const Mat22& whitening)
      : rig_(rig), side_(side), px_(px), whitening_(whitening) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const RigBlocks& rig_;
  Side side_;
  Vec2 px_;
  Mat22 whitening_;  ///< W with W^T W = cov^-1
};

/// Holds T_right_left near `given`: baseline length, its direction, rotation, each with its sigma.
class RigPriorCost final : public ceres::SizedCostFunction<6, 12> {
 public:
  RigPriorCost(const SE3& given, const Mat66& whitening) : given_(given), whitening_(whitening) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  SE3 given_;
  Mat66 whitening_;
};

/// Holds (fx, fy / fx, cx, cy, d0..d3) near the given ones.
class IntrinsicsPriorCost final : public ceres::SizedCostFunction<camera::kIntrinsicsCount, camera::kIntrinsicsCount> {
 public:
  using Values = std::array<double, camera::kIntrinsicsCount>;
  /// @param sigma  the second one is of fy / fx.
  IntrinsicsPriorCost(const Values& given, const Values& sigma) : given_(given), sigma_(sigma) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Values given_, sigma_;
};

/// fx fy cx cy d0 d1 d2 d3.
std::array<double, camera::kIntrinsicsCount> to_values(const camera::Intrinsics& intrinsics);
camera::Intrinsics with_values(camera::Intrinsics intrinsics, const double* values);

}  // namespace roomcal::tools
