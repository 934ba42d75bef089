#include "runtime/math/so3.h"

#include <cmath>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "runtime/math/numeric_diff.h"

namespace roomcal {
namespace {

const double kAngles_rad[] = {0, 1e-12, 1e-7, 1e-3, 0.0099, 0.0101, 0.5, 2.0, 3.0, kPi - 1e-6};
const Vec3 kAxis = Vec3(0.3, -0.8, 0.52).normalized();

TEST(So3, ExpThenLog_ReturnsTheVector) {
  for (const double angle : kAngles_rad) {
    const Vec3 phi = angle * kAxis;
    EXPECT_LT((so3_log(so3_exp(phi)) - phi).norm(), 1e-12) << angle;
  }
}

TEST(So3, LogOfHalfTurn_HasAngleLengthPi) { EXPECT_NEAR(so3_log(so3_exp(kPi * kAxis)).norm(), kPi, 1e-12); }

TEST(So3, Exp_IsARotation) {
  for (const double angle : kAngles_rad) {
    const Mat33 R = so3_exp(angle * kAxis);
    EXPECT_LT((R * R.transpose() - Mat33::Identity()).norm(), 1e-14);
    EXPECT_NEAR(R.determinant(), 1, 1e-14);
  }
}

TEST(So3, LeftJacobian_MeetsNumericDerivative) {
  for (const double angle : kAngles_rad) {
    if (angle > 3) continue;  // the numeric log is the limit there, not the Jacobian
    const Vec3 phi = angle * kAxis;
    const Mat33 R_inv = so3_exp(-phi);
    const Mat33 J = numeric_jacobian<3, 3>([&](const Vec3& x) -> Vec3 { return so3_log(so3_exp(x) * R_inv); }, phi);
    EXPECT_LT((so3_left_jacobian(phi) - J).norm(), 1e-8) << angle;
    EXPECT_LT((so3_left_jacobian(phi) * so3_left_jacobian_inverse(phi) - Mat33::Identity()).norm(), 1e-12) << angle;
  }
}

TEST(So3, NearestRotationOfARoundedOne_IsCloseAndProper) {
  const Mat33 R = so3_exp(1.2 * kAxis);
  const Mat33 M = (R * 1e4).array().round() / 1e4;
  EXPECT_LT((nearest_rotation(M) - R).norm(), 3e-4);
  EXPECT_NEAR(nearest_rotation(M).determinant(), 1, 1e-14);
}

}  // namespace
}  // namespace roomcal
