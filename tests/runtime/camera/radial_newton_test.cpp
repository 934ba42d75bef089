#include "runtime/camera/radial_newton.h"

#include <gtest/gtest.h>

namespace roomcal::camera {
namespace {

// x^3 - 1.5 x^2 + 0.7501 x: rising everywhere, almost flat at one half, where plain Newton is thrown far away.
ValueAndSlope with_a_flat_part(double x) { return {x * (0.7501 + x * (-1.5 + x)), 0.7501 - 3 * x + 3 * x * x}; }

TEST(SolveRadial, FunctionWithAFlatPart_IsInvertedEverywhere) {
  for (int i = 0; i <= 1000; ++i) {
    const double x = 2.0 * i / 1000;
    const double target = with_a_flat_part(x).value;
    EXPECT_NEAR(with_a_flat_part(solve_radial(with_a_flat_part, target, 2.0)).value, target, 1e-15 * (1 + target));
  }
}

TEST(SolveRadial, Ends_AreFound) {
  EXPECT_EQ(solve_radial(with_a_flat_part, 0.0, 2.0), 0.0);
  EXPECT_NEAR(solve_radial(with_a_flat_part, with_a_flat_part(2).value, 2.0), 2.0, 1e-15);
}

TEST(SolveRadial, TargetBeyondTheEnd_GivesTheEnd) {
  EXPECT_NEAR(solve_radial(with_a_flat_part, 100.0, 2.0), 2.0, 1e-15);
}

}  // namespace
}  // namespace roomcal::camera
