#include "runtime/math/dense_ldlt.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace roomcal {
namespace {

// A = B B^T + I / 10 with a fixed, irregular B.
std::vector<double> positive_definite(std::size_t n) {
  std::vector<double> B(n * n), A(n * n);
  for (std::size_t i = 0; i < n * n; ++i) B[i] = std::sin(1.7 * static_cast<double>(i * i % 101) + 0.3);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      A[i * n + j] = i == j ? 0.1 : 0;
      for (std::size_t k = 0; k < n; ++k) A[i * n + j] += B[i * n + k] * B[j * n + k];
    }
  return A;
}

TEST(DenseLdlt, Solve_SatisfiesTheSystem) {
  for (const std::size_t n : {1U, 2U, 6U, 13U, 48U}) {
    const std::vector<double> A = positive_definite(n);
    std::vector<double> LD = A, x(n), b(n, 0);
    for (std::size_t i = 0; i < n; ++i) x[i] = std::cos(static_cast<double>(i));
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) b[i] += A[i * n + j] * x[j];
    ASSERT_TRUE(ldlt_factor(LD, n).ok());
    ldlt_solve(LD, n, b);
    for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(b[i], x[i], 1e-10) << n;
  }
}

TEST(DenseLdlt, InverseTimesMatrix_IsIdentityAndSymmetric) {
  for (const std::size_t n : {1U, 6U, 24U, 48U}) {
    const std::vector<double> A = positive_definite(n);
    std::vector<double> LD = A, inverse(n * n);
    ASSERT_TRUE(ldlt_factor(LD, n).ok());
    ldlt_inverse(LD, n, inverse);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        double sum = 0;
        for (std::size_t k = 0; k < n; ++k) sum += A[i * n + k] * inverse[k * n + j];
        EXPECT_NEAR(sum, i == j ? 1 : 0, 1e-10);
        EXPECT_EQ(inverse[i * n + j], inverse[j * n + i]);
      }
  }
}

TEST(DenseLdlt, SingularIndefiniteOrNotANumber_IsDegenerate) {
  std::vector<double> singular = {1, 2, 2, 4}, indefinite = {1, 2, 2, 1}, zero = {0}, nan = {std::nan("")};
  EXPECT_EQ(ldlt_factor(singular, 2).code(), StatusCode::kDegenerate);
  EXPECT_EQ(ldlt_factor(indefinite, 2).code(), StatusCode::kDegenerate);
  EXPECT_EQ(ldlt_factor(zero, 1).code(), StatusCode::kDegenerate);
  EXPECT_EQ(ldlt_factor(nan, 1).code(), StatusCode::kDegenerate);
}

}  // namespace
}  // namespace roomcal
