#include "runtime/camera/field_limit.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace roomcal::camera {
namespace {

// Coefficients of prod (1 - x / root), positive at zero.
std::vector<double> with_roots(const std::vector<double>& roots) {
  std::vector<double> c = {1};
  for (const double root : roots) {
    c.push_back(0);
    for (std::size_t i = c.size() - 1; i > 0; --i) c[i] -= c[i - 1] / root;
  }
  return c;
}

TEST(FirstNonPositive, PolynomialWithoutARoot_GivesTheUpperEnd) {
  const double c[] = {1, 0, 2, 0, 1};
  EXPECT_EQ(first_non_positive(c, 7.5), 7.5);
}

TEST(FirstNonPositive, SeveralRoots_GivesTheSmallestPositiveOne) {
  EXPECT_NEAR(first_non_positive(with_roots({2.5, 0.75, -0.3, 1.5}), 10), 0.75, 1e-12);
  EXPECT_NEAR(first_non_positive(with_roots({3, 1, 2, 4, -5, 6, -7, 8, 9}), 10), 1, 1e-9);
}

TEST(FirstNonPositive, DipThatFitsBetweenAnySamples_IsFound) {
  EXPECT_NEAR(first_non_positive(with_roots({1.2345678, 1.2345679}), 3), 1.2345678, 1e-9);
}

TEST(FirstNonPositive, RootBeyondTheUpperEnd_IsNotReported) {
  EXPECT_EQ(first_non_positive(with_roots({2}), 1.5), 1.5);
}

TEST(FirstNonPositive, ConstantAndLinear_Work) {
  const double constant[] = {3};
  const double linear[] = {3, -2};
  EXPECT_EQ(first_non_positive(constant, 4), 4);
  EXPECT_NEAR(first_non_positive(linear, 4), 1.5, 1e-15);
}

TEST(CornerRadius, PrincipalPointOffCentre_TakesTheFarthestCorner) {
  Intrinsics intrinsics;
  intrinsics.width_px = 100;
  intrinsics.height_px = 50;
  intrinsics.fx_px = intrinsics.fy_px = 10;
  intrinsics.cx_px = 29.5;
  intrinsics.cy_px = 19.5;
  EXPECT_NEAR(corner_radius(intrinsics), std::hypot(7.0, 3.0), 1e-15);
}

}  // namespace
}  // namespace roomcal::camera
