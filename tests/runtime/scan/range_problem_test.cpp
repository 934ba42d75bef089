#include "runtime/scan/range_problem.h"

#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "runtime/math/numeric_diff.h"
#include "tests/runtime/scan/box.h"
#include "tests/runtime/scan/rays.h"
#include "tests/truth/random.h"

namespace roomcal::scan {
namespace {

using test::Ray;

SE3 random_pose(truth::Random& random) {
  return {so3_exp(random.normals<3>()), Vec3(1.5, 2, 1.3) + 0.3 * random.normals<3>()};
}

/// Exact rays in a box, offsets added.
std::vector<Ray> cast(const Surface& surface, const SE3& T, const std::vector<double>& offset_m, double sigma_m,
                      truth::Random& random) {
  const PosedSurface posed(surface, T);
  std::vector<Ray> rays;
  for (int i = 0; i < 3000; ++i) {
    Ray ray;
    ray.direction_lidar = random.normals<3>().normalized();
    ray.beam = static_cast<uint16_t>(random.index(offset_m.size()));
    ray.range_m = test::cast_one(posed, ray.direction_lidar).range_m + offset_m[ray.beam] + sigma_m * random.normal();
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
  gather(box.surface(), test::blocks_of(rays), sensor, state, {sensor.sigma_m, 1e6}, sums);  // plain least squares

  // The same by writing the whole 9 x 9 system down.
  Eigen::Matrix<double, 9, 9> A = Eigen::Matrix<double, 9, 9>::Zero();
  Eigen::Matrix<double, 9, 1> g = Eigen::Matrix<double, 9, 1>::Zero();
  const PosedSurface posed(box.surface(), T);
  for (const Ray& ray : rays) {
    const Face& face = box.surface().faces()[static_cast<std::size_t>(test::cast_one(posed, ray.direction_lidar).face)];
    const double speed = face.normal_room.dot(T.R * ray.direction_lidar);
    if (-speed < 0.08) continue;
    const double range_m = -(face.normal_room.dot(T.t) + face.d_m) / speed;
    const Vec3 n_lidar = T.R.transpose() * face.normal_room;
    Eigen::Matrix<double, 9, 1> J = Eigen::Matrix<double, 9, 1>::Zero();
    J.head<3>() = -n_lidar / speed;
    J.segment<3>(3) = -(range_m / speed) * ray.direction_lidar.cross(n_lidar);
    J[6 + ray.beam] = 1;
    const double w = 1 / (sensor.sigma_m * sensor.sigma_m);
    A += w * J * J.transpose();
    g += w * J * (ray.range_m - range_m - state.offset_m[ray.beam]);
  }
  for (int k = 0; k < 3; ++k) {
    const double prior = 1 / (sensor.beam_offset_sigma_m * sensor.beam_offset_sigma_m);
    A(6 + k, 6 + k) += prior;
    g[6 + k] -= prior * state.offset_m[static_cast<std::size_t>(k)];
  }
  const Eigen::Matrix<double, 9, 1> whole = A.inverse() * g;
  const PoseInformation pose = condense(sums, sensor, state);
  const Vec6 xi = pose.information.inverse() * pose.gradient;
  EXPECT_LT((xi - whole.head<6>()).norm(), 1e-7);  // floats within the pass: a thousandth of its sigma
  EXPECT_LT((pose.information.inverse() - A.inverse().topLeftCorner<6, 6>()).norm(), 1e-9);
  update_offsets(sums, sensor, xi, state);
  EXPECT_NEAR(state.offset_m[0], whole[6], 1e-7);
  EXPECT_NEAR(state.offset_m[1], -0.003 + whole[7], 1e-7);
}

TEST(Gather, TiltedBoxWithoutCeilingInView_AxisThatNothingShowsHasNoInformation) {
  const test::Box box(Vec3(3, 4, 2.7));
  truth::Random random(5);
  const SE3 T{so3_exp(Vec3(0.4, 0.3, 1)), Vec3(1.2, 1.7, 1.3)};  // no axis of the room is one of the sensor's
  std::vector<Ray> rays;
  const PosedSurface posed(box.surface(), T);
  while (rays.size() < 30000) {
    const Vec3 level = Vec3(random.normal(), random.normal(), 0.1 * random.normal()).normalized();
    Ray ray{T.R.transpose() * level, 0, 0};
    const test::Hit hit = test::cast_one(posed, ray.direction_lidar);
    if (hit.face < 2) continue;  // floor and ceiling
    ray.range_m = hit.range_m + 0.015 * random.normal();
    rays.push_back(ray);
  }
  RangeState state;
  state.T_room_lidar = T;
  RangeSums sums;
  gather(box.surface(), test::blocks_of(rays), {}, state, {}, sums);
  const Vec3 up_lidar = T.R.transpose() * Vec3::UnitZ();
  const double seen = sums.A.topLeftCorner<3, 3>().trace(),
               unseen = up_lidar.dot(sums.A.topLeftCorner<3, 3>() * up_lidar);
  EXPECT_GT(seen, 1e8);
  EXPECT_LT(std::abs(unseen), 1);  // a metre
}

TEST(TotalLoss, AnyState_IsTheLossOfAPassAndWhatItDidNotPredict) {
  const test::Box box(Vec3(3, 4, 2.7));
  truth::Random random(6);
  const SE3 T = random_pose(random);
  const std::vector<RayBlock> rays = test::blocks_of(cast(box.surface(), T, {0}, 0.015, random));
  for (int i = 0; i < 10; ++i) {
    RangeState state;
    state.T_room_lidar = T * se3_exp(0.02 * i * random.normals<6>());
    RangeSums sums;
    gather(box.surface(), rays, {}, state, {}, sums);
    const double by_hand = sums.loss + kUnmappedLoss * (sums.valid - sums.mapped);
    EXPECT_NEAR(total_loss(box.surface(), rays, {}, state, {}), by_hand, 1e-5 * by_hand);
  }
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
