#include "runtime/scan/range_problem.h"

#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "runtime/math/numeric_diff.h"
#include "tests/runtime/scan/box.h"
#include "tests/truth/random.h"

namespace roomcal::scan {
namespace {

SE3 random_pose(truth::Random& random) {
  return {so3_exp(random.normals<3>()), Vec3(1.5, 2, 1.3) + 0.3 * random.normals<3>()};
}

TEST(PredictRange, RandomPosesAndRays_JacobianIsTheNumericOne) {
  truth::Random random(2);
  for (int i = 0; i < 200; ++i) {
    const SE3 T = random_pose(random);
    const Vec3 normal_room = random.normals<3>().normalized();
    const double d_m = 2 - normal_room.dot(T.t);  // two metres in front of it
    const Vec3 direction = random.normals<3>().normalized();
    if (normal_room.dot(T.R * direction) > -0.2) continue;
    const auto range = [&](const Vec6& xi) {
      const SE3 moved = T * se3_exp(xi);
      const double height_m = normal_room.dot(moved.t) + d_m;
      return Eigen::Matrix<double, 1, 1>(predict_range(moved.R.transpose() * normal_room, height_m, direction).range_m);
    };
    const Eigen::Matrix<double, 1, 6> numeric = numeric_jacobian<1, 6>(range, Vec6(Vec6::Zero()));
    const RangePrediction at = predict_range(T.R.transpose() * normal_room, 2, direction);
    EXPECT_LT((numeric.transpose() - at.J).norm(), 1e-6 * (1 + at.J.norm()));
    // The point on the plane, by the plane's own equation.
    EXPECT_NEAR(normal_room.dot(T * Vec3(at.range_m * direction)) + d_m, 0, 1e-9);
  }
}

/// Exact rays in a box, offsets added.
std::vector<Ray> cast(const Surface& surface, const SE3& T, const std::vector<double>& offset_m, double sigma_m,
                      truth::Random& random) {
  PosedSurface posed;
  posed.set(surface, T);
  std::vector<Ray> rays;
  for (int i = 0; i < 3000; ++i) {
    Ray ray;
    ray.direction_lidar = random.normals<3>().normalized();
    ray.beam = static_cast<uint16_t>(random.index(offset_m.size()));
    ray.range_m = posed.first_hit(ray.direction_lidar).range_m + offset_m[ray.beam] + sigma_m * random.normal();
    rays.push_back(ray);
  }
  return rays;
}

TEST(Condense, OffsetsEliminated_IsTheSchurComplementOfTheWholeSystem) {
  const test::Box box(Vec3(3, 4, 2.7));
  truth::Random random(3);
  const SE3 T = random_pose(random);
  const std::vector<Ray> rays = cast(box.surface(), T, {0.004, -0.01, 0.002}, 0.015, random);
  SensorModel sensor;
  sensor.angle_sigma_rad = 0;
  RangeState state;
  state.T_room_lidar = T;
  state.offset_m[1] = -0.003;
  RangeSums sums;
  gather(box.surface(), rays, sensor, state, {1, sensor.sigma_m, 1e6, 0}, sums);  // plain least squares

  // The same by writing the whole 9 x 9 system down.
  Eigen::Matrix<double, 9, 9> A = Eigen::Matrix<double, 9, 9>::Zero();
  Eigen::Matrix<double, 9, 1> g = Eigen::Matrix<double, 9, 1>::Zero();
  PosedSurface posed;
  posed.set(box.surface(), T);
  for (const Ray& ray : rays) {
    const RayHit hit = posed.first_hit(ray.direction_lidar);
    const auto face = static_cast<std::size_t>(hit.face);
    const RangePrediction at = predict_range(posed.normal_lidar(face), posed.height_m(face), ray.direction_lidar);
    if (at.cos_incidence < 0.08) continue;
    Eigen::Matrix<double, 9, 1> J = Eigen::Matrix<double, 9, 1>::Zero();
    J.head<6>() = at.J;
    J[6 + ray.beam] = 1;
    const double w = 1 / (sensor.sigma_m * sensor.sigma_m);
    A += w * J * J.transpose();
    g += w * J * (ray.range_m - at.range_m - state.offset_m[ray.beam]);
  }
  for (int k = 0; k < 3; ++k) {
    const double prior = 1 / (sensor.beam_offset_sigma_m * sensor.beam_offset_sigma_m);
    A(6 + k, 6 + k) += prior;
    g[6 + k] -= prior * state.offset_m[static_cast<std::size_t>(k)];
  }
  const Eigen::Matrix<double, 9, 1> whole = A.inverse() * g;
  const PoseInformation pose = condense(sums, sensor, state);
  const Vec6 xi = pose.information.inverse() * pose.gradient;
  EXPECT_LT((xi - whole.head<6>()).norm(), 1e-9);
  EXPECT_LT((pose.information.inverse() - A.inverse().topLeftCorner<6, 6>()).norm(), 1e-12);
  update_offsets(sums, sensor, xi, state);
  EXPECT_NEAR(state.offset_m[0], whole[6], 1e-9);
  EXPECT_NEAR(state.offset_m[1], -0.003 + whole[7], 1e-9);
}

TEST(AddPrior, AtAnOffsetPose_PullsByTheGradientOfItsCost) {
  truth::Random random(4);
  PosePrior prior;
  prior.T_room_lidar = random_pose(random);
  const Mat66 root = 0.1 * Mat66::Identity() + 0.02 * Mat66::Random();
  prior.cov = root * root.transpose();
  const SE3 T = prior.T_room_lidar * se3_exp(0.1 * random.normals<6>());
  const auto half_cost = [&](const Vec6& xi) {
    const Vec6 off = se3_log(prior.T_room_lidar.inverse() * (T * se3_exp(xi)));
    return Eigen::Matrix<double, 1, 1>(0.5 * off.dot(prior.cov.inverse() * off));
  };
  const Eigen::Matrix<double, 1, 6> numeric = numeric_jacobian<1, 6>(half_cost, Vec6(Vec6::Zero()));
  Mat66 information = Mat66::Zero();
  Vec6 gradient = Vec6::Zero();
  add_prior(prior, T, information, gradient);
  EXPECT_LT((numeric.transpose() + gradient).norm(), 1e-5 * gradient.norm());
}

}  // namespace
}  // namespace roomcal::scan
