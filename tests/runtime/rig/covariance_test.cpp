#include "runtime/rig/covariance.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace roomcal::rig {
namespace {

// Information of two cameras, 1e6 on the diagonal (1 mm, 1 mrad), as the caller may change it.
std::vector<double> diagonal_information(double value = 1e6) {
  std::vector<double> S(144, 0.0);
  for (std::size_t i = 0; i < 12; ++i) S[13 * i] = value;
  return S;
}

TEST(InvertInformation, CoupledCameras_GivesTheInverse) {
  std::vector<double> S = diagonal_information();
  for (std::size_t i = 0; i < 6; ++i) S[12 * (6 + i) + i] = 5e5;  // lower blocks only
  std::vector<double> cov(144);
  std::size_t blamed = 0;
  ASSERT_TRUE(invert_information(S, 2, cov, blamed).ok());
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(cov[13 * i], 1e-6 / 0.75, 1e-15);
    EXPECT_NEAR(cov[12 * (6 + i) + i], -0.5e-6 / 0.75, 1e-15);
    EXPECT_EQ(cov[12 * (6 + i) + i], cov[12 * i + 6 + i]);
  }
}

TEST(InvertInformation, FreeMotionOfACamera_BlamesIt) {
  std::vector<double> S = diagonal_information(), cov(144);
  // Camera 1: rotation about x and translation along y can be exchanged.
  S[12 * 9 + 7] = -1e6;
  std::size_t blamed = 0;
  EXPECT_EQ(invert_information(S, 2, cov, blamed).code(), StatusCode::kDegenerate);
  EXPECT_EQ(blamed, 1U);
  S = diagonal_information();
  S[0] = 0;
  EXPECT_EQ(invert_information(S, 2, cov, blamed).code(), StatusCode::kDegenerate);
  EXPECT_EQ(blamed, 0U);
}

TEST(InvertInformation, SigmaBeyondAQuarter_IsDegenerate) {
  std::vector<double> cov(144);
  for (const double sigma : {0.24, 0.26}) {
    for (const std::size_t axis : {0U, 2U, 3U, 5U}) {
      std::vector<double> S = diagonal_information();
      S[13 * (6 + axis)] = 1 / (sigma * sigma);
      std::size_t blamed = 0;
      const Status status = invert_information(S, 2, cov, blamed);
      EXPECT_EQ(status.ok(), sigma < 0.25) << axis;
      EXPECT_EQ(blamed, 1U) << "the last one looked at";
    }
  }
}

TEST(InvertInformation, NotANumber_IsDegenerate) {
  std::vector<double> S = diagonal_information(), cov(144);
  S[12 * 3 + 1] = std::nan("");
  std::size_t blamed = 9;
  EXPECT_EQ(invert_information(S, 2, cov, blamed).code(), StatusCode::kDegenerate);
  EXPECT_EQ(blamed, 0U);
}

}  // namespace
}  // namespace roomcal::rig
