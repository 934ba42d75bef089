#include "runtime/scan/observability.h"

#include <cmath>
#include <cstdio>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace roomcal::scan {

namespace {

void add_weak(const Mat33& cov_room, bool rotation, double limit, WeakDirections& weak) {
  const Eigen::SelfAdjointEigenSolver<Mat33> axes(cov_room);
  for (int i = 2; i >= 0; --i) {
    const double sigma = std::sqrt(std::max(0.0, axes.eigenvalues()[i]));
    if (sigma <= limit || !weak.push_back({rotation, axes.eigenvectors().col(i), sigma})) return;
  }
}

const char* name_of(const WeakDirection& weak) {
  constexpr double kAlong = 0.9;  // 26 degrees
  const Vec3 a = weak.axis_room.cwiseAbs();
  if (weak.rotation) {
    if (a.z() > kAlong) return "heading";
    if (a.x() > kAlong) return "tilt about x";
    if (a.y() > kAlong) return "tilt about y";
    return "turn";
  }
  if (a.z() > kAlong) return "height";
  if (a.x() > kAlong) return "position along x";
  if (a.y() > kAlong) return "position along y";
  return "position";
}

}  // namespace

Mat66 covariance_of(const Mat66& information) {
  Mat66 regular = information;
  regular.diagonal().head<3>().array() += 1 / (kUnseenSigma_m * kUnseenSigma_m);
  regular.diagonal().tail<3>().array() += 1 / (kUnseenSigma_rad * kUnseenSigma_rad);
  const Mat66 cov = regular.ldlt().solve(Mat66::Identity());
  return 0.5 * (cov + cov.transpose());
}

WeakDirections find_weak_directions(const Mat66& information, const Mat33& R_room_lidar,
                                    const ObservabilityLimits& limits) {
  const Mat66 cov = covariance_of(information);
  WeakDirections weak;
  add_weak(R_room_lidar * cov.topLeftCorner<3, 3>() * R_room_lidar.transpose(), false, limits.sigma_m, weak);
  add_weak(R_room_lidar * cov.bottomRightCorner<3, 3>() * R_room_lidar.transpose(), true, limits.sigma_rad, weak);
  return weak;
}

FixedText<96> describe(const WeakDirection& weak) {
  const char* name = name_of(weak);
  const double unseen = weak.rotation ? kUnseenSigma_rad : kUnseenSigma_m;
  const char* seen = weak.sigma > unseen / 20 ? "not seen" : "weakly seen";
  char text[96];
  int length = std::snprintf(text, sizeof text, "%s %s, 1-sigma ", name, seen);
  const auto room = sizeof text - static_cast<std::size_t>(length);
  const double number = weak.rotation ? rad_to_deg(weak.sigma) : 1e3 * weak.sigma;
  const char* format = number < 10 ? "%.2g %s" : "%.0f %s";  // two digits, never an exponent
  length += std::snprintf(text + length, room, format, number, weak.rotation ? "deg" : "mm");
  return FixedText<96>(std::string_view(text, static_cast<std::size_t>(length)));
}

}  // namespace roomcal::scan
