#include "tools/common/random.h"

#include <cmath>

#include <gtest/gtest.h>

namespace roomcal::tools {
namespace {

// First outputs for seed 1234567, from the reference implementation (prng.di.unimi.it/splitmix64.c).
TEST(Random, KnownSeed_GivesReferenceBits) {
  Random random(1234567);
  EXPECT_EQ(random.bits(), 6457827717110365317U);
  EXPECT_EQ(random.bits(), 3203168211198807973U);
}

TEST(Random, Normal_HasUnitMoments) {
  Random random(5);
  constexpr int kCount = 100000;
  double sum = 0, squares = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.normal();
    ASSERT_TRUE(std::isfinite(x));
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / kCount, 0, 4 / std::sqrt(kCount));
  EXPECT_NEAR(squares / kCount, 1, 4 * std::sqrt(2.0 / kCount));
}

TEST(Random, Uniform_StaysInRange) {
  Random random(6);
  for (int i = 0; i < 10000; ++i) {
    const double x = random.uniform(-2, 3);
    EXPECT_TRUE(x >= -2 && x < 3);
    EXPECT_LT(random.below(7), 7U);
  }
}

}  // namespace
}  // namespace roomcal::tools
