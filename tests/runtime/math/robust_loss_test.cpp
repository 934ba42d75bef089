#include "runtime/math/robust_loss.h"

#include <gtest/gtest.h>

namespace roomcal {
namespace {

TEST(RedescendingLoss, InsideTheTurnOver_IsLeastSquares) {
  const RedescendingLoss loss(3);
  for (const double s : {0.0, 1e-12, 1.0, 8.999}) {
    EXPECT_EQ(loss(s).loss, s);
    EXPECT_EQ(loss(s).weight, 1);
  }
}

TEST(RedescendingLoss, Weight_IsTheDerivativeOfTheLoss) {
  const RedescendingLoss loss(2.5);
  for (const double s : {0.5, 6.2, 6.3, 10.0, 100.0, 1e4}) {
    const double step = 1e-5 * s;
    EXPECT_NEAR(loss(s).weight, (loss(s + step).loss - loss(s - step).loss) / (2 * step), 1e-6) << s;
  }
}

TEST(RedescendingLoss, AtTheTurnOver_IsContinuous) {
  const RedescendingLoss loss(3);
  EXPECT_NEAR(loss(9 + 1e-12).loss, 9, 1e-11);
  EXPECT_NEAR(loss(9 + 1e-12).weight, 1, 1e-11);
}

TEST(RedescendingLoss, FarAway_IsBoundedAndPullsLessAndLess) {
  const RedescendingLoss loss(3);
  EXPECT_LT(loss(1e12).loss, loss.max_loss());
  EXPECT_NEAR(loss(1e20).loss, loss.max_loss(), 1e-6);
  EXPECT_LT(loss(1e6).weight * 1e3, loss(1e4).weight * 1e2);
  EXPECT_LT(loss(2.2 * 2.2 * 9).weight, RedescendingLoss::kOutlierWeight);
  EXPECT_GT(loss(2.1 * 2.1 * 9).weight, RedescendingLoss::kOutlierWeight);
}

}  // namespace
}  // namespace roomcal
