#include "runtime/rig/covariance.h"

#include <cmath>

#include <Eigen/Eigenvalues>

#include "runtime/math/dense_ldlt.h"
#include "runtime/math/types.h"

namespace roomcal::rig {

namespace {

// Markers in general position give 1e-4 and more (a narrow lens; 1e-2 for a wide one), a free motion gives rounding.
constexpr double kMinScaledEigenvalue = 1e-10;
// Beyond a quarter of a metre or of a radian, in this room, the linear covariance says nothing any more.
constexpr double kMaxSigma = 0.25;

constexpr Status kUndetermined{StatusCode::kDegenerate,
                               "its markers do not determine the camera's pose: turn or move the device so that this "
                               "camera sees more markers, spread over the image and not in one line"};

Mat66 diagonal_block(std::span<const double> M, std::size_t size, std::size_t view) {
  Mat66 block;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      const double value = M[(6 * view + i) * size + 6 * view + j];
      block(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = value;
      block(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i)) = value;
    }
  return block;
}

bool every_motion_seen(const Mat66& information) {
  if (!(information.diagonal().minCoeff() > 0)) return false;
  const Vec6 scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Mat66 scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Mat66> solver(scaled, Eigen::EigenvaluesOnly);
  return solver.info() == Eigen::Success && solver.eigenvalues()[0] > kMinScaledEigenvalue;
}

bool sigma_small(const Mat33& cov) {
  const Eigen::SelfAdjointEigenSolver<Mat33> solver(cov, Eigen::EigenvaluesOnly);
  return solver.info() == Eigen::Success && solver.eigenvalues()[2] < kMaxSigma * kMaxSigma;
}

}  // namespace

Status invert_information(std::span<double> information, std::size_t sensors, std::span<double> cov,
                          std::size_t& degenerate_view, std::size_t lidars, std::size_t others) {
  const std::size_t size = 6 * sensors + others, cameras = sensors - lidars;
  for (std::size_t view = 0; view < cameras; ++view) {
    degenerate_view = view;
    if (!every_motion_seen(diagonal_block(information, size, view))) return kUndetermined;
  }
  if (!ldlt_factor(information, size).ok()) return kUndetermined;
  ldlt_inverse(information, size, cov);
  for (std::size_t view = 0; view < cameras; ++view) {
    degenerate_view = view;
    const Mat66 block = diagonal_block(cov, size, view);
    if (!sigma_small(block.topLeftCorner<3, 3>()) || !sigma_small(block.bottomRightCorner<3, 3>()))
      return kUndetermined;
  }
  return ok_status();
}

}  // namespace roomcal::rig
