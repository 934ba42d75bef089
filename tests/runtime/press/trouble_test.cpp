#include "runtime/press/trouble.h"

#include <memory>

#include <gtest/gtest.h>

namespace roomcal::press {
namespace {

/// Two located cameras and a located LiDAR that did not pass.
class TroubleOf : public testing::Test {
 protected:
  TroubleOf() {
    outcome_->verdict = Verdict::kFailRetry;
    for (int i = 0; i < 2; ++i) {
      calib::CameraOutcome camera;
      camera.has_image = camera.located = true;
      camera.detections = rings_;
      EXPECT_TRUE(outcome_->cameras.push_back(camera));
    }
    EXPECT_TRUE(outcome_->lidars.push_back({}));
  }
  Trouble trouble() const { return trouble_of(*outcome_); }

  std::array<marker::Detection, 3> rings_{};
  std::unique_ptr<calib::Outcome> outcome_ = std::make_unique<calib::Outcome>();
};

TEST_F(TroubleOf, WhatMayBeWritten_IsNone) {
  outcome_->cameras[0].failure = "cam0: blocked";
  for (const Verdict verdict : {Verdict::kPass, Verdict::kPassAdvise}) {
    outcome_->verdict = verdict;
    EXPECT_EQ(trouble(), Trouble::kNone);
  }
}

TEST_F(TroubleOf, VerdictForService_IsServiceWhateverElse) {
  outcome_->verdict = Verdict::kFailService;
  outcome_->cameras[0].has_image = false;
  EXPECT_EQ(trouble(), Trouble::kService);
}

TEST_F(TroubleOf, NothingLost_IsThePlace) { EXPECT_EQ(trouble(), Trouble::kPlace); }

TEST_F(TroubleOf, CameraWithoutImage_ComesBeforeAllElse) {
  outcome_->lidars[0].failure = "lidar0: no packets";
  outcome_->cameras[0].failure = "cam0: not located";
  outcome_->cameras[1].has_image = false;
  EXPECT_EQ(trouble(), Trouble::kImages);
}

TEST_F(TroubleOf, PictureThatWasNotLookedAt_IsTheImages) {
  outcome_->cameras[1].failure = "cam1: too dark";
  outcome_->cameras[1].detections = {};
  EXPECT_EQ(trouble(), Trouble::kImages);
}

TEST_F(TroubleOf, CameraThatSeesRingsAndIsLost_IsThePlace) {
  outcome_->lidars[0].failure = "lidar0: no packets";
  outcome_->cameras[1].failure = "cam1: more than one place fits";
  EXPECT_EQ(trouble(), Trouble::kPlace);
}

TEST_F(TroubleOf, LidarAlone_IsTheLidar) {
  outcome_->lidars[0].failure = "lidar0: no packets";
  EXPECT_EQ(trouble(), Trouble::kLidar);
}

}  // namespace
}  // namespace roomcal::press
