#include "runtime/scan/weigh_block.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/math/numeric_diff.h"
#include "runtime/math/robust_loss.h"
#include "tests/runtime/scan/box.h"
#include "tests/runtime/scan/rays.h"
#include "tests/truth/random.h"

namespace roomcal::scan {
namespace {

using test::Ray;

WeighOptions plain_options(double sigma_m) {
  WeighOptions options;
  options.variance_m2 = static_cast<float>(sigma_m * sigma_m);
  options.face_weight.fill(1);
  options.face_weight[kNoFace] = 0;
  options.offset_m.fill(0);
  return options;
}

struct Weighed {
  Weighed(const Surface& surface, const SE3& T, std::span<const Ray> rays, const WeighOptions& options)
      : posed(surface, T), block(test::blocks_of(rays)[0]) {
    posed.cast(block, hits);
    weigh_block(posed, block, hits, options, of);
  }
  PosedSurface posed;
  RayBlock block;
  BlockHits hits;
  WeighedBlock of;
};

/// Range to a face by its equation, in double precision.
double range_m(const Face& face, const SE3& T, const Vec3& direction_lidar) {
  return -(face.normal_room.dot(T.t) + face.d_m) / face.normal_room.dot(T.R * direction_lidar);
}

TEST(WeighBlock, RandomPosesAndRays_DerivativesAreTheNumericOnes) {
  const test::Box box(Vec3(3, 4, 2.7));
  truth::Random random(2);
  for (int pose = 0; pose < 30; ++pose) {
    const SE3 T{so3_exp(random.normals<3>()), Vec3(1.5, 2, 1.3) + 0.3 * random.normals<3>()};
    std::vector<Ray> rays(kBlockRays);
    for (Ray& ray : rays) ray = {random.normals<3>().normalized(), 2, 0};
    const Weighed weighed(box.surface(), T, rays, plain_options(0.015));
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if ((weighed.of.flags[i] & kRayMapped) == 0) continue;
      const Face& face = box.surface().faces()[static_cast<std::size_t>(weighed.hits.face[i])];
      const auto range = [&](const Vec6& xi) {
        return Eigen::Matrix<double, 1, 1>(range_m(face, T * se3_exp(xi), rays[i].direction_lidar));
      };
      const Eigen::Matrix<double, 1, 6> numeric = numeric_jacobian<1, 6>(range, Vec6(Vec6::Zero()));
      Vec6 J;
      for (int k = 0; k < 6; ++k) J[k] = static_cast<double>(weighed.of.J[static_cast<std::size_t>(k)][i]);
      EXPECT_LT((numeric.transpose() - J).norm(), 1e-5 * (1 + J.norm()));
      EXPECT_NEAR(static_cast<double>(weighed.of.residual_m[i]), 2 - range(Vec6::Zero())[0], 2e-6);
    }
  }
}

TEST(WeighBlock, ResidualsOfAllSizes_WeighedByTheRobustLoss) {
  const test::Box box(Vec3(3, 4, 2.7));
  const SE3 T{Mat33::Identity(), Vec3(1, 2, 1)};
  const RedescendingLoss loss(3);
  std::vector<Ray> rays;
  for (int i = 0; i < 40; ++i) rays.push_back({Vec3::UnitX(), 2 + 0.005 * (i - 20), 3});
  WeighOptions options = plain_options(0.015);
  options.offset_m[3] = 0.01F;
  const Weighed weighed(box.surface(), T, rays, options);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double off_m = 0.005 * (static_cast<double>(i) - 20) - 0.01;
    const LossAndWeight truth = loss(off_m * off_m / (0.015 * 0.015));
    EXPECT_NEAR(static_cast<double>(weighed.of.loss[i]), truth.loss, 1e-3);
    EXPECT_NEAR(static_cast<double>(weighed.of.weight[i]) * 0.015 * 0.015, truth.weight, 1e-4);
    EXPECT_EQ((weighed.of.flags[i] & kRayInlier) != 0, truth.weight >= RedescendingLoss::kOutlierWeight);
    EXPECT_EQ((weighed.of.flags[i] & kRayBeyond) != 0, off_m > 5 * 0.015);
  }
}

TEST(WeighBlock, GrazingMutedMissedAndBackFaces_CarryNoWeight) {
  const test::Box box(Vec3(3, 4, 2.7));
  WeighOptions options = plain_options(0.015);
  options.face_weight[3] = 0;  // wall x1
  const std::vector<Ray> inside = {
      {Vec3::UnitX(), 2, 0}, {-Vec3::UnitX(), 1, 0}, {Vec3(1, 0.0, -0.01).normalized(), 1, 0}};
  const Weighed weighed(box.surface(), {Mat33::Identity(), Vec3(1, 2, 0.01)}, inside, options);
  EXPECT_EQ(weighed.of.weight[0], 0);
  EXPECT_EQ(weighed.of.flags[0], kRayMapped | kRayInlier);
  EXPECT_GT(weighed.of.weight[1], 0);
  EXPECT_EQ(weighed.of.flags[2], 0);  // the floor, at half a degree
  const std::vector<Ray> outside = {{Vec3::UnitX(), 2, 0}, {-Vec3::UnitX(), 1, 0}};
  const Weighed wrong(box.surface(), {Mat33::Identity(), Vec3(-1, 2, 1)}, outside, options);
  EXPECT_EQ(wrong.of.flags[0], kRayBeyond);
  EXPECT_EQ(wrong.of.loss[0], 27);
  EXPECT_EQ(wrong.of.flags[1], 0);
  for (std::size_t i = 0; i < kBlockRays; ++i) {
    EXPECT_EQ(wrong.of.weight[i], 0);
    for (const BlockFloats& J : wrong.of.J) EXPECT_TRUE(std::isfinite(J[i]));
  }
}

TEST(WeighBlock, AngleSigma_CountsWhereABeamGrazes) {
  const test::Box box(Vec3(3, 4, 2.7));
  WeighOptions options = plain_options(0.015);
  options.angle_variance = 1e-4F;
  const Vec3 flat = Vec3(1.8, 0, -1).normalized();
  const std::vector<Ray> rays = {{Vec3::UnitX(), 2, 0}, {flat, 2, 0}};
  const Weighed weighed(box.surface(), {Mat33::Identity(), Vec3(1, 2, 1)}, rays, options);
  EXPECT_NEAR(static_cast<double>(weighed.of.information[0]) * 0.015 * 0.015, 1, 1e-5);
  const double range_m = std::hypot(1.8, 1.0), tan = 1.8;
  EXPECT_NEAR(1 / static_cast<double>(weighed.of.information[1]), 0.015 * 0.015 + 1e-4 * tan * tan * range_m * range_m,
              1e-7);
}

TEST(WeighEvidence, FaceOrPlaneBehind_TheBetterOneGetsIt) {
  const test::Box box(Vec3(3, 4, 2.7));
  const SE3 T{Mat33::Identity(), Vec3(1, 2, 1)};
  const Vec3 down = Vec3(2, 0, -1.1).normalized();  // the floor, 0.21 m before wall x1
  const WeighOptions options = plain_options(0.015);
  const std::vector<Ray> rays = {{down, down.z() == 0 ? 0 : -1 / down.z(), 0}, {down, 2 / down.x(), 0}};
  const Weighed weighed(box.surface(), T, rays, options);
  BlockHits behind;
  weighed.posed.cast_behind(weighed.block, weighed.hits, behind);
  BlockFloats evidence;
  weigh_evidence(weighed.block, behind, options, weighed.of, 9, evidence);
  EXPECT_GT(evidence[0], 15);
  EXPECT_LT(evidence[1], -15);
  EXPECT_EQ(evidence[2], 0);
}

TEST(LaneSums, Blocks_AreSummedAsByHand) {
  const test::Box box(Vec3(3, 4, 2.7));
  const SE3 T{so3_exp(Vec3(0.2, 0.1, 0.4)), Vec3(1, 2, 1)};
  truth::Random random(7);
  LaneSums lanes;
  Mat66 A = Mat66::Zero();
  Vec6 g = Vec6::Zero();
  double loss = 0;
  for (int b = 0; b < 20; ++b) {
    std::vector<Ray> rays(50);
    for (Ray& ray : rays) ray = {random.normals<3>().normalized(), random.uniform(0.5, 3), 0};
    const Weighed weighed(box.surface(), T, rays, plain_options(0.5));
    add_block(weighed.of, lanes);
    for (std::size_t i = 0; i < kBlockRays; ++i) {
      Vec6 J;
      for (int k = 0; k < 6; ++k) J[k] = static_cast<double>(weighed.of.J[static_cast<std::size_t>(k)][i]);
      A += static_cast<double>(weighed.of.weight[i]) * J * J.transpose();
      g += static_cast<double>(weighed.of.weight[i]) * static_cast<double>(weighed.of.residual_m[i]) * J;
      loss += static_cast<double>(weighed.of.loss[i]);
    }
  }
  std::size_t which = 0;
  for (int c = 0; c < 6; ++c) {
    for (int r = c; r < 6; ++r) EXPECT_NEAR(lanes.total(which++), A(r, c), 1e-6 * A.norm());
    EXPECT_NEAR(lanes.total(LaneSums::kProducts + static_cast<std::size_t>(c)), g[c], 1e-6 * g.norm());
  }
  EXPECT_NEAR(lanes.total(LaneSums::kLoss), loss, 1e-6 * loss);
}

}  // namespace
}  // namespace roomcal::scan
