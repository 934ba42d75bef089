#include "runtime/camera/pinhole_radtan.h"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "runtime/camera/field_limit.h"
#include "runtime/math/numeric_diff.h"
#include "tests/runtime/camera/lenses.h"

namespace roomcal::camera {
namespace {

constexpr double kFar = 1e3;

double smallest_eigenvalue(const PinholeRadtan& lens, const Vec2& m) {
  Mat22 J;
  EXPECT_TRUE(lens.distort(m, &J).allFinite());
  return Eigen::SelfAdjointEigenSolver<Mat22>(J).eigenvalues()[0];
}

Vec2 polar(double radius, double azimuth_rad) { return radius * Vec2(std::cos(azimuth_rad), std::sin(azimuth_rad)); }

TEST(PinholeRadtan, DistortJacobians_MeetNumericDerivatives) {
  const PinholeRadtan lens{-0.3, 0.09, 0.02, -0.03};
  for (const double radius : {0.0, 0.1, 0.5, 0.9}) {
    for (int i = 0; i < 8; ++i) {
      const Vec2 m = polar(radius, 0.3 + i * kPi / 4);
      Mat22 J;
      const Vec2 m_d = lens.distort(m, &J);
      EXPECT_EQ(m_d, lens.distort(m));
      const Mat22 numeric = numeric_jacobian<2, 2>([&](const Vec2& x) -> Vec2 { return lens.distort(x); }, m);
      EXPECT_LT((J - numeric).norm(), 1e-8);
      EXPECT_NEAR(J(0, 1), J(1, 0), 1e-15);
      const auto f = [&](const Vec4& k) -> Vec2 { return PinholeRadtan{k[0], k[1], k[2], k[3]}.distort(m); };
      const auto numeric_k = numeric_jacobian<2, 4>(f, Vec4(lens.k1, lens.k2, lens.p1, lens.p2));
      EXPECT_LT((PinholeRadtan::parameter_jacobian(m) - numeric_k).norm(), 1e-8);
    }
  }
}

TEST(PinholeRadtan, NoDistortion_IsLimitedBelow90Degrees) {
  EXPECT_NEAR(std::atan(PinholeRadtan{}.max_radius(kFar)), deg_to_rad(89), 1e-12);
}

TEST(PinholeRadtan, RadialFold_LimitsTheField) {
  // Slope 1 + 3 k1 r^2 is zero at r = 1.
  const PinholeRadtan lens{-1.0 / 3, 0, 0, 0};
  EXPECT_NEAR(lens.max_radius(kFar), std::sqrt(1 - kMinSlope), 1e-12);
}

TEST(PinholeRadtan, JacobianOverTheField_IsPositiveDefiniteAndTheLimitIsTight) {
  for (const auto& item : test::kLenses) {
    if (item.intrinsics.model != Model::kPinholeRadtan) continue;
    const PinholeRadtan lens = PinholeRadtan::from(item.intrinsics);
    const double limit = lens.max_radius(kFar);
    double least_beyond = 1;
    for (int a = 0; a < 360; ++a) {
      for (int i = 0; i <= 200; ++i)
        EXPECT_GE(smallest_eigenvalue(lens, polar(limit * i / 200, deg_to_rad(a))), kMinSlope * (1 - 1e-6))
            << item.name;
      least_beyond = std::min(least_beyond, smallest_eigenvalue(lens, polar(limit * 1.01, deg_to_rad(a))));
    }
    const bool folds = limit < 0.99 * std::tan(deg_to_rad(89)) && lens.distort({limit, 0}).norm() < 0.9 * kFar;
    if (folds && lens.k1 < 0) {
      EXPECT_LT(least_beyond, kMinSlope) << item.name;
    }
  }
}

TEST(PinholeRadtan, UndistortOverTheField_InvertsToRounding) {
  for (const auto& item : test::kLenses) {
    if (item.intrinsics.model != Model::kPinholeRadtan) continue;
    const PinholeRadtan lens = PinholeRadtan::from(item.intrinsics);
    const double limit = lens.max_radius(10);
    for (int a = 0; a < 360; a += 5) {
      for (int i = 0; i <= 200; ++i) {
        const Vec2 m_d = lens.distort(polar(limit * i / 200, deg_to_rad(a)));
        Vec2 m;
        ASSERT_TRUE(lens.undistort(m_d, limit, m)) << item.name << " " << a << " " << i;
        EXPECT_LT((lens.distort(m) - m_d).norm(), 2e-15 * (1 + m_d.norm())) << item.name << " " << a << " " << i;
      }
    }
  }
}

TEST(PinholeRadtan, PointBeyondTheField_HasNoInverse) {
  const PinholeRadtan lens{-0.3, 0, 0.01, 0};
  const double limit = lens.max_radius(kFar);
  Vec2 m(4, 5);
  for (int a = 0; a < 360; a += 5) {
    EXPECT_FALSE(lens.undistort(1.01 * lens.distort(polar(limit, deg_to_rad(a))), limit, m));
    EXPECT_FALSE(lens.undistort(polar(1e6, deg_to_rad(a)), limit, m));
  }
  EXPECT_EQ(m, Vec2(4, 5));
}

}  // namespace
}  // namespace roomcal::camera
