#include "runtime/pose/p3p.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/truth/random.h"

namespace roomcal::pose {
namespace {

struct Case {
  std::array<Vec3, 3> bearing_cam;
  std::array<Vec3, 3> point_room;
  SE3 T_room_cam;
};

Case random_case(truth::Random& random) {
  Case c;
  c.T_room_cam = {so3_exp(random.uniform(0, 3.1) * random.normals<3>().normalized()), 2.0 * random.normals<3>()};
  for (std::size_t i = 0; i < 3; ++i) {
    // Any direction, behind a pinhole's image plane too: a fisheye sees it.
    c.bearing_cam[i] = random.normals<3>().normalized();
    c.point_room[i] = c.T_room_cam * (random.uniform(0.3, 5.0) * c.bearing_cam[i]);
  }
  return c;
}

Status solve(const Case& c, P3pPoses& poses) {
  return solve_p3p(std::span<const Vec3, 3>(c.bearing_cam), std::span<const Vec3, 3>(c.point_room), poses);
}

double distance(const SE3& a, const SE3& b) { return (a.R - b.R).norm() + (a.t - b.t).norm(); }

TEST(P3p, RandomTriangles_TruthIsAmongTheAnswers) {
  truth::Random random(1);
  P3pPoses poses;
  int missed = 0;
  constexpr int kCases = 20000;
  for (int k = 0; k < kCases; ++k) {
    const Case c = random_case(random);
    ASSERT_TRUE(solve(c, poses).ok());
    double nearest = 1e9;
    for (const SE3& T : poses) nearest = std::min(nearest, distance(T, c.T_room_cam));
    if (nearest > 1e-5) ++missed;
  }
  // On the danger cylinder two answers coincide, and rounding may take them off the real axis.
  EXPECT_LE(missed, 2);
}

TEST(P3p, EveryAnswer_SeesThePointsAtTheBearings) {
  truth::Random random(2);
  P3pPoses poses;
  std::size_t answers = 0;
  std::size_t bad = 0;
  for (int k = 0; k < 20000; ++k) {
    const Case c = random_case(random);
    ASSERT_TRUE(solve(c, poses).ok());
    for (const SE3& T : poses) {
      ++answers;
      EXPECT_NEAR(T.R.determinant(), 1.0, 1e-6);
      for (std::size_t i = 0; i < 3; ++i) {
        if (((T.inverse() * c.point_room[i]).normalized() - c.bearing_cam[i]).norm() > 1e-5) {
          ++bad;
          break;
        }
      }
    }
  }
  EXPECT_GT(answers, 20000u);
  EXPECT_LT(static_cast<double>(bad), 1e-3 * static_cast<double>(answers));
}

TEST(P3p, NoisyBearings_AnswerStaysNear) {
  truth::Random random(3);
  P3pPoses poses;
  const std::array<Vec3, 3> point = {Vec3(0, 0, 0), Vec3(0.5, 0, 0), Vec3(0.1, 0.6, 0)};
  const SE3 T_room_cam{so3_exp(Vec3(kPi - 0.3, 0.2, 0.1)), Vec3(0.3, 0.2, 2.0)};
  for (int k = 0; k < 200; ++k) {
    std::array<Vec3, 3> bearing;
    for (std::size_t i = 0; i < 3; ++i) {
      bearing[i] = ((T_room_cam.inverse() * point[i]).normalized() + 1e-5 * random.normals<3>()).normalized();
    }
    ASSERT_TRUE(solve_p3p(std::span<const Vec3, 3>(bearing), std::span<const Vec3, 3>(point), poses).ok());
    double nearest = 1e9;
    for (const SE3& T : poses) nearest = std::min(nearest, distance(T, T_room_cam));
    EXPECT_LT(nearest, 0.02);
  }
}

TEST(P3p, CollinearPoints_ReportsDegenerate) {
  truth::Random random(4);
  Case c = random_case(random);
  c.point_room[2] = 0.3 * c.point_room[0] + 0.7 * c.point_room[1];
  P3pPoses poses;
  EXPECT_EQ(solve(c, poses).code(), StatusCode::kDegenerate);
  EXPECT_TRUE(poses.empty());
}

TEST(P3p, CoincidentPoints_ReportsDegenerate) {
  truth::Random random(5);
  Case c = random_case(random);
  c.point_room[1] = c.point_room[0];
  P3pPoses poses;
  EXPECT_EQ(solve(c, poses).code(), StatusCode::kDegenerate);
}

TEST(P3p, BearingsInOnePlane_ReportsDegenerate) {
  truth::Random random(6);
  Case c = random_case(random);
  c.bearing_cam[2] = (c.bearing_cam[0] + c.bearing_cam[1]).normalized();
  P3pPoses poses;
  EXPECT_EQ(solve(c, poses).code(), StatusCode::kDegenerate);
  c.bearing_cam[1] = c.bearing_cam[0];
  EXPECT_EQ(solve(c, poses).code(), StatusCode::kDegenerate);
}

TEST(P3p, NotFinite_NoAnswer) {
  truth::Random random(7);
  P3pPoses poses;
  Case c = random_case(random);
  c.point_room[1].x() = NAN;
  EXPECT_FALSE(solve(c, poses).ok() && !poses.empty());
  c = random_case(random);
  c.bearing_cam[0].y() = NAN;
  EXPECT_FALSE(solve(c, poses).ok() && !poses.empty());
}

}  // namespace
}  // namespace roomcal::pose
