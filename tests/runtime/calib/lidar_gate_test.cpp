#include "runtime/calib/lidar_gate.h"

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "runtime/calib/lidar_models.h"

namespace roomcal::calib {
namespace {

/// A LiDAR that every gate lets pass; each test spoils one thing.
class LidarGate : public testing::Test {
 protected:
  LidarGate() {
    spec_.name = lidar_.name = "lidar0";
    spec_.ranges = *ranges_of("vlp16");
    spec_.nominal = {true, SE3{Mat33::Identity(), Vec3(0, 0.1, 0)}, deg_to_rad(1.0), 0.008};
    lidar_.located = lidar_.in_rig = lidar_.mount_took_part = true;
    lidar_.sweeps = lidar_.used_sweeps = 1;
    lidar_.T_rig_lidar = spec_.nominal.T_rig_sensor;
    lidar_.cov_rig_lidar = 1e-8 * Mat66::Identity();
  }
  void expect(Verdict verdict, const std::string& words) {
    Judgement judgement(*outcome_);
    judge_lidar(spec_, lidar_, Limits(), judgement);
    EXPECT_EQ(outcome_->verdict, verdict);
    ASSERT_EQ(outcome_->reasons.size(), words.empty() ? 0U : 1U);
    if (words.empty()) return;
    const std::string reason(outcome_->reasons[0].view());
    EXPECT_NE(reason.find(words), std::string::npos) << reason;
  }

  LidarSpec spec_;
  LidarOutcome lidar_;
  std::unique_ptr<Outcome> outcome_ = std::make_unique<Outcome>();
};

TEST_F(LidarGate, CleanLidar_Passes) { expect(Verdict::kPass, ""); }

TEST_F(LidarGate, NotLocated_FailsWithItsReason) {
  lidar_.located = false;
  lidar_.failure = "lidar0: no packets: check";
  expect(Verdict::kFailRetry, "lidar0: no packets");
}

TEST_F(LidarGate, UnseenHeightWithMounting_AdvisesByName) {
  static_cast<void>(lidar_.location.weak.push_back({false, Vec3::UnitZ(), 0.14}));
  lidar_.cov_rig_lidar(2, 2) = 64e-6;  // the mounting's 8 mm
  expect(Verdict::kPassAdvise, "lidar0: height not seen, 1-sigma 140 mm");
}

TEST_F(LidarGate, UnseenHeightWithoutMounting_IsARetry) {
  static_cast<void>(lidar_.location.weak.push_back({false, Vec3::UnitZ(), 0.14}));
  lidar_.mount_took_part = false;
  expect(Verdict::kFailRetry, "lidar0: height not seen");
}

TEST_F(LidarGate, UnseenHeight_DoesNotHideALooseAxisThatTheSweepSees) {
  static_cast<void>(lidar_.location.weak.push_back({false, Vec3::UnitZ(), 0.14}));
  lidar_.cov_rig_lidar(2, 2) = 64e-6;
  lidar_.cov_rig_lidar(0, 0) = 1e-4;  // of the reference camera, say
  Judgement judgement(*outcome_);
  judge_lidar(spec_, lidar_, Limits(), judgement);
  EXPECT_EQ(outcome_->verdict, Verdict::kFailRetry);
  ASSERT_EQ(outcome_->reasons.size(), 2U);
  EXPECT_NE(outcome_->reasons[1].view().find("lidar0: 1-sigma of 10.00 mm"), std::string_view::npos);
}

TEST_F(LidarGate, ElsewhereThanItsMounting_AsksForService) {
  lidar_.located = false;
  lidar_.failure = "lidar0: its sweep puts it";
  lidar_.failure_verdict = Verdict::kFailService;
  expect(Verdict::kFailService, "lidar0: its sweep puts it");
}

TEST_F(LidarGate, LooseCovariance_IsARetry) {
  lidar_.cov_rig_lidar(0, 0) = 1e-4;
  expect(Verdict::kFailRetry, "lidar0: 1-sigma of 10.00 mm");
}

TEST_F(LidarGate, FarFromNominal_FailsForService) {
  lidar_.T_rig_lidar.t.x() = 0.05;
  expect(Verdict::kFailService, "lidar0: sits 50.0 mm");
}

TEST_F(LidarGate, SweepsLeftOutAndBadBeam_Advise) {
  lidar_.sweeps = 3;
  expect(Verdict::kPassAdvise, "lidar0: 2 of its 3 sweeps");
  lidar_.sweeps = 1;
  lidar_.location.beam_count = 5;
  lidar_.location.beam[4] = {0.06, 0.001, 500};
  expect(Verdict::kPassAdvise, "lidar0: beam 4 is off by 60 mm");
}

}  // namespace
}  // namespace roomcal::calib
