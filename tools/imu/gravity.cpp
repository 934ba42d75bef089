#include "tools/imu/gravity.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <fmt/core.h>

#include "tools/common/error.h"

namespace roomcal::tools {

namespace {

constexpr double kUnseen_rad = deg_to_rad(1);
constexpr double kOpen_rad = 0.5;     // of an axis that nothing fixes, as in the joint solution
constexpr double kNotGravity = 0.1;   // of g
constexpr double kMaxChi2Sigmas = 6;  // beyond the mean of chi-square
constexpr int kRounds = 20;

/// Unknowns: rotation 0..2, bias 3..5, level 6..7, g 8; attitude of the stances goes into their noise.
constexpr Eigen::Index kSize = 9;
using Vec9 = Eigen::Matrix<double, kSize, 1>;
using Mat99 = Eigen::Matrix<double, kSize, kSize>;

struct State {
  Mat33 R_rig_imu;
  Vec3 bias = Vec3::Zero();
  Vec2 level = Vec2::Zero();
  double g = 0;

  Vec3 held_up_room() const { return so3_exp(Vec3(level.x(), level.y(), 0)) * Vec3(0, 0, g); }
};

/// The rotation that fits best, the axis that gravity leaves open as the drawing has it (Wahba, by SVD).
Mat33 start(const std::vector<Stance>& stances, const GravityPrior& prior) {
  const double weak = prior.mounted ? 1e-3 : 1e-9;
  Mat33 B = weak * prior.R_rig_imu;
  for (const Stance& stance : stances)
    B += (stance.R_room_rig.transpose() * Vec3::UnitZ()) * stance.held_up_mps2.normalized().transpose();
  const Eigen::JacobiSVD<Mat33> svd(B, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  return svd.matrixU() * Vec3(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
}

class Problem {
 public:
  Problem(const std::vector<Stance>& stances, const GravityPrior& prior) : stances_(stances), prior_(prior) {
    at_.R_rig_imu = start(stances, prior);
    at_.g = prior.gravity_mps2;
  }

  void solve() {
    for (int round = 0; round < kRounds; ++round) {
      linearize();
      const Vec9 step = -(H_ + mount_).ldlt().solve(g_);
      at_.R_rig_imu = at_.R_rig_imu * so3_exp(step.head<3>());
      at_.bias += step.segment<3>(3);
      at_.level += step.segment<2>(6);
      at_.g += step[8];
      if (step.norm() < 1e-12) break;
    }
    linearize();
  }

  ImuRotation result() const {
    ImuRotation out;
    out.R_rig_imu = at_.R_rig_imu;
    const Mat99 cov = (H_ + mount_).ldlt().solve(Mat99::Identity());
    out.cov = cov.topLeftCorner<3, 3>();
    out.bias_mps2 = at_.bias;
    out.bias_sigma_mps2 = cov.diagonal().segment<3>(3).cwiseSqrt();
    out.chi2 = chi2_;
    judge_axes(out);
    out.degrees_of_freedom = static_cast<int>(3 * stances_.size()) - out.seen;
    return out;
  }

 private:
  void linearize() {
    H_.setZero();
    g_.setZero();
    chi2_ = 0;
    for (const Stance& stance : stances_) add_stance(stance);
    for (Eigen::Index i = 0; i < 3; ++i) add_prior(3 + i, at_.bias[i], prior_.bias_sigma_mps2);
    for (Eigen::Index i = 0; i < 2; ++i) add_prior(6 + i, at_.level[i], prior_.level_sigma_rad);
    add_prior(8, at_.g - prior_.gravity_mps2, prior_.gravity_sigma_mps2);
    mount_.setZero();
    const double sigma = prior_.mounted ? prior_.mount_sigma_rad : kOpen_rad;
    mount_.topLeftCorner<3, 3>() = Mat33::Identity() / (sigma * sigma);
    if (prior_.mounted) g_.head<3>() += so3_log(prior_.R_rig_imu.transpose() * at_.R_rig_imu) / (sigma * sigma);
  }

  void add_stance(const Stance& stance) {
    const Mat33 R_imu_room = at_.R_rig_imu.transpose() * stance.R_room_rig.transpose();
    const Vec3 up_room = at_.held_up_room(), predicted = R_imu_room * up_room;
    const Vec3 residual = predicted + at_.bias - stance.held_up_mps2;
    Eigen::Matrix<double, 3, kSize> J;
    J.leftCols<3>() = hat(predicted);  // exp(-xi) v = v + v x xi
    J.middleCols<3>(3).setIdentity();
    J.middleCols<2>(6) = -(R_imu_room * hat(up_room)).leftCols<2>();
    J.col(8) = predicted / at_.g;
    const Mat33 by_attitude = prior_.attitude_sigma_rad * hat(predicted);
    const Mat33 cov = Mat33(stance.sigma_mps2.cwiseAbs2().asDiagonal()) + by_attitude * by_attitude.transpose();
    const Mat33 weight = cov.inverse();
    H_ += J.transpose() * weight * J;
    g_ += J.transpose() * weight * residual;
    chi2_ += residual.dot(weight * residual);
  }

  void add_prior(Eigen::Index i, double off, double sigma) {
    H_(i, i) += 1 / (sigma * sigma);
    g_[i] += off / (sigma * sigma);
    chi2_ += off * off / (sigma * sigma);
  }

  /// Which axes gravity tells, whatever the drawing says.
  void judge_axes(ImuRotation& out) const {
    Mat99 open = H_;
    open.topLeftCorner<3, 3>().diagonal().array() += 1 / (kOpen_rad * kOpen_rad);
    const Mat99 cov = open.ldlt().solve(Mat99::Identity());
    const Eigen::SelfAdjointEigenSolver<Mat33> axes(cov.topLeftCorner<3, 3>());
    out.unseen_sigma_rad = std::sqrt(axes.eigenvalues()[2]);
    out.seen = out.unseen_sigma_rad > kUnseen_rad ? 2 : 3;
    if (out.seen == 2) out.unseen_rig = at_.R_rig_imu * axes.eigenvectors().col(2);
  }

  const std::vector<Stance>& stances_;
  const GravityPrior& prior_;
  State at_;
  Mat99 H_ = Mat99::Zero(), mount_ = Mat99::Zero();
  Vec9 g_ = Vec9::Zero();
  double chi2_ = 0;
};

}  // namespace

ImuRotation find_imu_rotation(const std::vector<Stance>& stances, const GravityPrior& prior) {
  if (stances.empty()) throw ToolError("no stance: give samples of an IMU at rest");
  for (const Stance& stance : stances)
    if (!(std::abs(stance.held_up_mps2.norm() / prior.gravity_mps2 - 1) < kNotGravity))
      throw ToolError(fmt::format("the IMU feels {:.3f} m/s^2, gravity is {:.3f}: did it rest, and is that its unit?",
                                  stance.held_up_mps2.norm(), prior.gravity_mps2));
  Problem problem(stances, prior);
  problem.solve();
  const ImuRotation out = problem.result();
  const double n = out.degrees_of_freedom;
  if (!(out.chi2 < n + kMaxChi2Sigmas * std::sqrt(2 * n)))
    throw ToolError(
        fmt::format("the stances contradict each other (chi2 {:.0f} of {}): the IMU moved on the rig, or "
                    "its bias is larger than {} m/s^2",
                    out.chi2, out.degrees_of_freedom, prior.bias_sigma_mps2));
  return out;
}

}  // namespace roomcal::tools
