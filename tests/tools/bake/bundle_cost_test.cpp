#include "tools/bake/bundle_cost.h"

#include <gtest/gtest.h>

#include "runtime/math/numeric_diff.h"
#include "tests/tools/bake/synthetic_survey.h"

namespace roomcal::tools {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

const SE3 kT_room_left = se3_exp((Vec6() << 0.3, -1.2, 0.7, 0.4, 0.3, -1.1).finished());
const Vec3 kPoint_room = kT_room_left * Vec3(0.3, -0.2, 2.1);
const Mat22 kWhitening = (Mat22() << 2, 0.3, 0, 1.5).finished();

class ReprojectionCostOfSide : public testing::TestWithParam<Side> {};

TEST_P(ReprojectionCostOfSide, Jacobians_AgreeWithDifferences) {
  const Side side = GetParam();
  const StereoRig given = test::make_stereo_rig();
  RigBlocks rig(given);
  const ReprojectionCost cost(rig, side, {600, 500}, kWhitening);
  const auto residual = [&](const SE3& T_room_left, const Vec3& p, const SE3& T_side_left) {
    const PoseBlock pose(T_room_left), mount(T_side_left);
    const double* parameters[4] = {pose.x.data(), p.data(), mount.x.data(), rig.intrinsics(side)};
    Vec2 r;
    EXPECT_TRUE(cost.Evaluate(parameters, r.data(), nullptr));
    return r;
  };
  const SE3 T_side_left = side == kLeft ? SE3{} : given.T_right_left;
  const PoseBlock pose(kT_room_left), mount(T_side_left);
  const double* parameters[4] = {pose.x.data(), kPoint_room.data(), mount.x.data(), rig.intrinsics(side)};
  RowMajor J_pose(2, 12), J_point(2, 3), J_mount(2, 12), J_k(2, camera::kIntrinsicsCount);
  double* jacobians[4] = {J_pose.data(), J_point.data(), J_mount.data(), J_k.data()};
  Vec2 r;
  ASSERT_TRUE(cost.Evaluate(parameters, r.data(), jacobians));
  const Mat26 pose_numeric = numeric_jacobian<2, 6>(
      [&](const Vec6& xi) { return residual(kT_room_left * se3_exp(xi), kPoint_room, T_side_left); }, Vec6::Zero());
  const Mat23 point_numeric =
      numeric_jacobian<2, 3>([&](const Vec3& p) { return residual(kT_room_left, p, T_side_left); }, kPoint_room);
  const Mat26 mount_numeric = numeric_jacobian<2, 6>(
      [&](const Vec6& xi) { return residual(kT_room_left, kPoint_room, T_side_left * se3_exp(xi)); }, Vec6::Zero());
  EXPECT_LT((J_pose.leftCols<6>() - pose_numeric).norm(), 1e-4);
  EXPECT_LT((J_point - point_numeric).norm(), 1e-4);
  EXPECT_LT((J_mount.leftCols<6>() - mount_numeric).norm(), 1e-4);
  EXPECT_EQ(J_pose.rightCols<6>().norm(), 0);
}

INSTANTIATE_TEST_SUITE_P(Sides, ReprojectionCostOfSide, testing::Values(kLeft, kRight));

TEST(RigPriorCost, Jacobian_AgreesWithDifferences) {
  const SE3 given = test::make_stereo_rig().T_right_left;
  const SE3 T = given * se3_exp((Vec6() << 0.01, 0.02, -0.01, 0.1, -0.2, 0.15).finished());
  const RigPriorCost cost(given, 3 * Mat66::Identity());
  const auto residual = [&](const Vec6& xi) {
    const PoseBlock pose(T * se3_exp(xi));
    const double* parameters[1] = {pose.x.data()};
    Vec6 r;
    EXPECT_TRUE(cost.Evaluate(parameters, r.data(), nullptr));
    return r;
  };
  const PoseBlock pose(T);
  const double* parameters[1] = {pose.x.data()};
  RowMajor J(6, 12);
  double* jacobians[1] = {J.data()};
  Vec6 r;
  ASSERT_TRUE(cost.Evaluate(parameters, r.data(), jacobians));
  EXPECT_LT((J.leftCols<6>() - numeric_jacobian<6, 6>(residual, Vec6::Zero())).norm(), 1e-7);
}

}  // namespace
}  // namespace roomcal::tools
