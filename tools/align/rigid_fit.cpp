#include "tools/align/rigid_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace roomcal::tools {

namespace {

Vec3 centroid(std::span<const Vec3> points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

}  // namespace

SE3 fit_rigid(std::span<const Vec3> p_a, std::span<const Vec3> p_b) {
  const Vec3 centre_a = centroid(p_a), centre_b = centroid(p_b);
  Mat33 moment = Mat33::Zero();
  for (std::size_t i = 0; i < p_a.size(); ++i) moment += (p_a[i] - centre_a) * (p_b[i] - centre_b).transpose();
  const Eigen::JacobiSVD<Mat33> svd(moment, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat33 sign = Mat33::Identity();
  sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const Mat33 R_a_b = svd.matrixU() * sign * svd.matrixV().transpose();
  return {R_a_b, centre_a - R_a_b * centre_b};
}

double fit_scale(std::span<const Vec3> p_a, std::span<const Vec3> p_b, const SE3& T_a_b) {
  const Vec3 centre_a = centroid(p_a), centre_b = centroid(p_b);
  double cross = 0, own = 0;
  for (std::size_t i = 0; i < p_a.size(); ++i) {
    cross += (p_a[i] - centre_a).dot(T_a_b.R * (p_b[i] - centre_b));
    own += (p_b[i] - centre_b).squaredNorm();
  }
  return own > 0 ? cross / own : 1;
}

SE3 fit_rigid_weighted(std::span<const SpacePoint> a, std::span<const SpacePoint> b, const PointPairs& pairs,
                       SE3 T_a_b) {
  for (int round = 0; round < 3; ++round) {
    Mat66 H = Mat66::Zero();
    Vec6 g = Vec6::Zero();
    for (const auto& [i, j] : pairs) {
      const Mat33 weight = (a[i].cov_m2 + T_a_b.R * b[j].cov_m2 * T_a_b.R.transpose()).inverse();
      // T exp(xi) p = T p + R rho - R [p]x phi
      Eigen::Matrix<double, 3, 6> J;
      J << T_a_b.R, -T_a_b.R * hat(b[j].p);
      H += J.transpose() * weight * J;
      g += J.transpose() * weight * (T_a_b * b[j].p - a[i].p);
    }
    T_a_b = T_a_b * se3_exp(-H.ldlt().solve(g));
  }
  return T_a_b;
}

}  // namespace roomcal::tools
