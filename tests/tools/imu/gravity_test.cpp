#include "tools/imu/gravity.h"

#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/truth/random.h"
#include "tools/common/error.h"

namespace roomcal::tools {
namespace {

/// An IMU on a rig that stands in several places, all that is uncertain drawn from the prior.
class Drawn {
 public:
  Drawn(uint64_t seed, const GravityPrior& prior)
      : R_rig_imu(so3_exp(Vec3(0.4, -1.1, 2.0))), random_(seed), prior_(prior) {
    bias = prior.bias_sigma_mps2 * random_.normals<3>();
    const Vec2 level = prior.level_sigma_rad * random_.normals<2>();
    held_up_room_ = so3_exp(Vec3(level.x(), level.y(), 0)) *
                    Vec3(0, 0, prior.gravity_mps2 + prior.gravity_sigma_mps2 * random_.normal());
  }

  Stance stand(const Vec3& lean_rad) {
    const Mat33 R_room_rig = so3_exp(Vec3(0, 0, random_.uniform(0, 6))) * so3_exp(lean_rad);
    Stance stance;
    stance.R_room_rig = R_room_rig * so3_exp(prior_.attitude_sigma_rad * random_.normals<3>());
    stance.sigma_mps2 = Vec3(0.001, 0.001, 0.002);
    stance.held_up_mps2 = R_rig_imu.transpose() * R_room_rig.transpose() * held_up_room_ + bias +
                          stance.sigma_mps2.cwiseProduct(random_.normals<3>());
    return stance;
  }

  Vec3 error_of(const ImuRotation& found) const { return so3_log(found.R_rig_imu.transpose() * R_rig_imu); }

  Mat33 R_rig_imu;
  Vec3 bias;

 private:
  truth::Random random_;
  const GravityPrior& prior_;
  Vec3 held_up_room_;
};

std::vector<Stance> leaning(Drawn& drawn) {
  std::vector<Stance> stances;
  for (const Vec3& lean : {Vec3(0.3, 0, 0), Vec3(-0.2, 0.3, 0), Vec3(0, -0.35, 0.1), Vec3(0.1, 0.1, 0)})
    stances.push_back(drawn.stand(lean));
  return stances;
}

TEST(ImuRotation, OneStance_SeesTwoDegreesOfFreedomAndNamesTheThird) {
  const GravityPrior prior;
  Drawn drawn(1, prior);
  const Vec3 lean(0.1, 0, 0);
  const std::vector<Stance> stances = {drawn.stand(lean)};
  const ImuRotation found = find_imu_rotation(stances, prior);
  EXPECT_EQ(found.seen, 2);
  const Vec3 up_rig = stances[0].R_room_rig.transpose() * Vec3::UnitZ();
  EXPECT_GT(std::abs(found.unseen_rig.dot(up_rig)), 0.999);
  EXPECT_GT(found.unseen_sigma_rad, 0.3);
  // What is seen is right: gravity lies where it is felt, whatever the heading.
  const Vec3 truth = drawn.R_rig_imu.transpose() * up_rig, seen = found.R_rig_imu.transpose() * up_rig;
  EXPECT_LT(std::acos(std::min(1.0, truth.dot(seen))), deg_to_rad(0.5));
}

TEST(ImuRotation, UprightInManyPlaces_StillSeesTwo) {
  const GravityPrior prior;
  Drawn drawn(2, prior);
  std::vector<Stance> stances;
  for (int i = 0; i < 6; ++i) stances.push_back(drawn.stand(Vec3::Zero()));
  const ImuRotation found = find_imu_rotation(stances, prior);
  EXPECT_EQ(found.seen, 2);
  EXPECT_GT(std::abs(found.unseen_rig.z()), 0.999);
}

TEST(ImuRotation, LeaningStances_SeeThreeAndErrorsAreAsTheCovarianceSays) {
  constexpr int kDraws = 400;
  const GravityPrior prior;
  double nees = 0, chi2 = 0;
  int degrees_of_freedom = 0;
  for (int i = 0; i < kDraws; ++i) {
    Drawn drawn(static_cast<uint64_t>(100 + i), prior);
    const ImuRotation found = find_imu_rotation(leaning(drawn), prior);
    EXPECT_EQ(found.seen, 3);
    const Vec3 error = drawn.error_of(found);
    EXPECT_LT(error.norm(), deg_to_rad(2));
    nees += error.dot(found.cov.inverse() * error) / kDraws;
    chi2 += found.chi2 / kDraws;
    degrees_of_freedom = found.degrees_of_freedom;
  }
  std::printf("four leaning stances: mean NEES %.2f of 3, chi2 %.2f of %d\n", nees, chi2, degrees_of_freedom);
  EXPECT_NEAR(nees, 3, 0.36);  // sigma of the mean: sqrt(6 / 400) = 0.12
  EXPECT_NEAR(chi2, degrees_of_freedom, 0.7);
}

TEST(ImuRotation, Drawing_CarriesTheHeadingAtItsOwnWidth) {
  GravityPrior prior;
  prior.mounted = true;
  prior.mount_sigma_rad = deg_to_rad(1);
  constexpr int kDraws = 300;
  double nees = 0;
  truth::Random random(9);
  for (int i = 0; i < kDraws; ++i) {
    Drawn drawn(static_cast<uint64_t>(1000 + i), prior);
    prior.R_rig_imu = drawn.R_rig_imu * so3_exp(prior.mount_sigma_rad * random.normals<3>());
    const ImuRotation found = find_imu_rotation({drawn.stand(Vec3(0.05, 0.02, 0))}, prior);
    EXPECT_EQ(found.seen, 2);
    EXPECT_NEAR(std::sqrt(found.cov.trace()), deg_to_rad(1.04), deg_to_rad(0.05));
    const Vec3 error = drawn.error_of(found);
    nees += error.dot(found.cov.inverse() * error) / kDraws;
  }
  std::printf("one stance and a drawing: mean NEES %.2f of 3\n", nees);
  EXPECT_NEAR(nees, 3, 0.42);
}

TEST(ImuRotation, WhatIsNotGravityOrContradictsItself_IsRefused) {
  const GravityPrior prior;
  Drawn drawn(3, prior);
  std::vector<Stance> stances = leaning(drawn);
  EXPECT_THROW(find_imu_rotation({}, prior), ToolError);
  stances[1].held_up_mps2 *= 0.101971621;  // in units of g
  EXPECT_THROW(find_imu_rotation(stances, prior), ToolError);
  stances = leaning(drawn);
  stances[2].held_up_mps2 = so3_exp(Vec3(0.03, 0, 0)) * stances[2].held_up_mps2;  // it moved
  EXPECT_THROW(find_imu_rotation(stances, prior), ToolError);
}

}  // namespace
}  // namespace roomcal::tools
