#include "runtime/calib/compare_installed.h"

#include <array>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace roomcal::calib {
namespace {

constexpr double kSigma = 1e-4;  // m and rad, of every pose

/// Three cameras: an installed record, and a shot in which one of them may have moved.
class CompareInstalled : public testing::Test {
 protected:
  CompareInstalled() {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::array<const char*, 3> names = {"cam0", "cam1", "cam2"};
      T_rig_[i].t = Vec3(0.1 * static_cast<double>(i), 0, 0);
      store::SensorRecord sensor;
      sensor.name = names[i];
      sensor.T_rig_sensor = T_rig_[i];
      if (i > 0) sensor.cov_rig_sensor = 2 * kSigma * kSigma * Mat66::Identity();
      static_cast<void>(installed_->sensors.push_back(sensor));
      CameraOutcome camera;
      camera.name = names[i];
      camera.located = camera.in_rig = true;
      camera.view = i;
      static_cast<void>(outcome_->cameras.push_back(camera));
    }
  }

  const InstalledCheck& compare() {
    for (std::size_t i = 0; i < 18; ++i) cov_[19 * i] = kSigma * kSigma;
    outcome_->solution.T_room_sensor = T_rig_;
    outcome_->solution.cov_room = cov_;
    const Session session{
        .device = *device_, .map = map_, .index = index_, .limits = {}, .installed = installed_.get()};
    compare_installed(session, *outcome_);
    return outcome_->installed;
  }

  std::array<SE3, 3> T_rig_{};
  std::vector<double> cov_ = std::vector<double>(18 * 18, 0.0);
  std::unique_ptr<store::Record> installed_ = std::make_unique<store::Record>();
  std::unique_ptr<Outcome> outcome_ = std::make_unique<Outcome>();
  std::unique_ptr<Device> device_ = std::make_unique<Device>();
  map::RoomMap map_;
  map::TriangleIndex index_;
};

TEST_F(CompareInstalled, NothingMoved_SaysSo) {
  const InstalledCheck& check = compare();
  EXPECT_TRUE(check.done);
  EXPECT_FALSE(check.moved);
  EXPECT_EQ(check.p_value, 1);
}

TEST_F(CompareInstalled, MovedCamera_IsNamedWithItsDelta) {
  T_rig_[2] = T_rig_[2] * se3_exp((Vec6() << 0.005, 0, 0, 0, 0, 0).finished());
  const InstalledCheck& check = compare();
  EXPECT_TRUE(check.moved);
  EXPECT_EQ(check.moved_sensor.view(), "cam2");
  EXPECT_NEAR(check.sensors[2].delta[0], 0.005, 1e-12);
  EXPECT_LT(check.p_value, 1e-9);
  EXPECT_GT(check.sensors[1].p_value, 0.5);
}

TEST_F(CompareInstalled, MovedReference_IsNamedItself) {
  T_rig_[0] = T_rig_[0] * se3_exp((Vec6() << 0, 0, 0, 0, 0.005, 0).finished());
  EXPECT_EQ(compare().moved_sensor.view(), "cam0");
}

TEST_F(CompareInstalled, OpenDirection_DoesNotSpeak) {
  T_rig_[1] = T_rig_[1] * se3_exp((Vec6() << 0, 0, 0.005, 0, 0, 0).finished());
  installed_->sensors[1].cov_rig_sensor(2, 2) = 64e-6;
  EXPECT_FALSE(compare().moved);
}

TEST_F(CompareInstalled, SensorNotInTheShot_IsSkipped) {
  outcome_->cameras[1].located = outcome_->cameras[1].in_rig = false;
  const InstalledCheck& check = compare();
  EXPECT_TRUE(check.done);
  EXPECT_FALSE(check.sensors[1].comparable);
}

TEST(ChiSquareTail, KnownQuantiles_AreMet) {  // R: pchisq(x, 6, lower.tail = FALSE)
  EXPECT_NEAR(chi_square_6_tail(5.348121), 0.5, 1e-6);
  EXPECT_NEAR(chi_square_6_tail(12.59159), 0.05, 1e-6);
  EXPECT_NEAR(chi_square_6_tail(22.45774), 0.001, 1e-8);
}

}  // namespace
}  // namespace roomcal::calib
