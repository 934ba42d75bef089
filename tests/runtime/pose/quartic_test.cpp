#include "runtime/pose/quartic.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/truth/random.h"

namespace roomcal::pose {
namespace {

std::array<double, 5> from_roots(double a, double b, double c, double d) {
  // (x^2 + p x + q)(x^2 + r x + s)
  const double p = -(a + b);
  const double q = a * b;
  const double r = -(c + d);
  const double s = c * d;
  return {1.0, p + r, q + s + p * r, p * s + q * r, q * s};
}

double nearest(const FixedVector<double, 4>& roots, double value) {
  double best = 1e9;
  for (const double root : roots) best = std::min(best, std::abs(root - value));
  return best;
}

TEST(Quartic, FourRealRoots_AllFound) {
  truth::Random random(1);
  FixedVector<double, 4> roots;
  for (int k = 0; k < 10000; ++k) {
    const double known[4] = {random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2),
                             random.uniform(-2, 2)};
    solve_quartic(from_roots(known[0], known[1], known[2], known[3]), roots);
    ASSERT_EQ(roots.size(), 4u);
    for (const double root : known) EXPECT_LT(nearest(roots, root), 1e-3);
  }
}

TEST(Quartic, TwoComplexRoots_OnlyTheRealOnes) {
  truth::Random random(2);
  FixedVector<double, 4> roots;
  for (int k = 0; k < 1000; ++k) {
    const double a = random.uniform(-1, 1);
    const double b = random.uniform(1.5, 2);
    const double p = random.uniform(-1, 1);
    // x^2 + p x + q with q > p^2 / 4
    const double q = 0.25 * p * p + random.uniform(0.1, 1);
    solve_quartic({1.0, p - a - b, q - p * (a + b) + a * b, a * b * p - q * (a + b), a * b * q}, roots);
    ASSERT_EQ(roots.size(), 2u);
    EXPECT_LT(nearest(roots, a), 1e-9);
    EXPECT_LT(nearest(roots, b), 1e-9);
  }
}

TEST(Quartic, NoRealRoot_Empty) {
  FixedVector<double, 4> roots;
  solve_quartic({1, 0, 2, 0, 3}, roots);
  EXPECT_TRUE(roots.empty());
}

TEST(Quartic, Biquadratic_FourRoots) {
  FixedVector<double, 4> roots;
  solve_quartic({1, 0, -5, 0, 4}, roots);
  ASSERT_EQ(roots.size(), 4u);
  for (const double root : {-2.0, -1.0, 1.0, 2.0}) EXPECT_LT(nearest(roots, root), 1e-12);
}

TEST(Quartic, LeadingCoefficientsVanish_LowerDegreeSolved) {
  FixedVector<double, 4> roots;
  solve_quartic({0, 1, -6, 11, -6}, roots);
  ASSERT_EQ(roots.size(), 3u);
  for (const double root : {1.0, 2.0, 3.0}) EXPECT_LT(nearest(roots, root), 1e-9);
  solve_quartic({0, 0, 1, -3, 2}, roots);
  ASSERT_EQ(roots.size(), 2u);
  solve_quartic({0, 0, 0, 2, -3}, roots);
  ASSERT_EQ(roots.size(), 1u);
  EXPECT_NEAR(roots[0], 1.5, 1e-12);
}

TEST(Quartic, NotFinite_Empty) {
  FixedVector<double, 4> roots;
  solve_quartic({1, NAN, 0, 0, 1}, roots);
  EXPECT_TRUE(roots.empty());
}

}  // namespace
}  // namespace roomcal::pose
