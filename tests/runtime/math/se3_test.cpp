#include "runtime/math/se3.h"

#include <gtest/gtest.h>

#include "runtime/math/numeric_diff.h"

namespace roomcal {
namespace {

Vec6 make_xi(double angle_rad) {
  Vec6 xi;
  xi << 0.4, -1.3, 2.2, angle_rad * Vec3(0.3, -0.8, 0.52).normalized();
  return xi;
}

const double kAngles_rad[] = {0, 1e-9, 1e-4, 0.0999, 0.1001, 1.0, 2.5};

TEST(Se3, ExpThenLog_ReturnsTheVector) {
  for (const double angle : kAngles_rad) EXPECT_LT((se3_log(se3_exp(make_xi(angle))) - make_xi(angle)).norm(), 1e-11);
}

TEST(Se3, InverseTimesItself_IsIdentity) {
  const SE3 T_a_b = se3_exp(make_xi(1.0));
  const SE3 T_a_a = T_a_b * T_a_b.inverse();
  EXPECT_LT((T_a_a.matrix() - Mat44::Identity()).norm(), 1e-14);
}

TEST(Se3, Adjoint_MovesAPerturbationToTheOtherSide) {
  const SE3 T = se3_exp(make_xi(1.0));
  const Vec6 xi = 0.3 * make_xi(0.7);
  const Mat44 right = (T * se3_exp(xi)).matrix();
  const Mat44 left = (se3_exp(se3_adjoint(T) * xi) * T).matrix();
  EXPECT_LT((left - right).norm(), 1e-13);
}

TEST(Se3, RightJacobian_MeetsNumericDerivative) {
  for (const double angle : kAngles_rad) {
    const Vec6 xi = make_xi(angle);
    const SE3 T_inv = se3_exp(xi).inverse();
    const Mat66 J = numeric_jacobian<6, 6>([&](const Vec6& x) -> Vec6 { return se3_log(T_inv * se3_exp(x)); }, xi);
    EXPECT_LT((se3_right_jacobian(xi) - J).norm(), 1e-7) << angle;
    EXPECT_LT((se3_right_jacobian(xi) * se3_right_jacobian_inverse(xi) - Mat66::Identity()).norm(), 1e-11) << angle;
  }
}

TEST(Se3, FromRoundedMatrix_IsARigidTransform) {
  const SE3 T = se3_exp(make_xi(1.0));
  const Mat44 rounded = (T.matrix() * 1e5).array().round() / 1e5;
  const SE3 back = SE3::from_matrix(rounded);
  EXPECT_LT((back.R * back.R.transpose() - Mat33::Identity()).norm(), 1e-14);
  EXPECT_LT((back.matrix() - T.matrix()).norm(), 1e-4);
}

}  // namespace
}  // namespace roomcal
