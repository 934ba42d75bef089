#include "runtime/calib/quality_gate.h"

#include <array>
#include <limits>
#include <memory>
#include <string>

#include <gtest/gtest.h>

namespace roomcal::calib {
namespace {

/// A shot of two cameras that every gate lets pass; each test spoils one thing.
class QualityGate : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"cam0", "cam1"}) {
      CameraSpec spec;
      spec.name = name;
      spec.nominal = {true, SE3{Mat33::Identity(), Vec3(0.1, 0, 0)}, deg_to_rad(1.0), 0.008};
      ASSERT_TRUE(device_.cameras.push_back(spec));
      CameraOutcome camera;
      camera.name = name;
      camera.has_image = camera.located = camera.in_rig = true;
      camera.usable_detections = camera_inliers_.size();
      camera.inliers = camera_inliers_;
      camera.coverage = 0.8;
      camera.T_rig_cam.t = Vec3(0.102, 0.001, -0.003);
      camera.cov_rig_cam = Mat66::Identity() * 1e-10;
      ASSERT_TRUE(outcome_.cameras.push_back(camera));
    }
    outcome_.solution.chi2 = 100;
    outcome_.solution.degrees_of_freedom = 100;
  }

  CameraOutcome& cam1() { return outcome_.cameras[1]; }

  /// The one reason, which must name the camera or the fit, and the verdict.
  void expect(Verdict verdict, const std::string& words) {
    judge(device_, Limits(), outcome_);
    EXPECT_EQ(outcome_.verdict, verdict);
    ASSERT_EQ(outcome_.reasons.size(), 1u);
    const std::string reason(outcome_.reasons[0].view());
    EXPECT_NE(reason.find(words), std::string::npos) << reason;
  }

  std::array<pose::Correspondence, 20> camera_inliers_{};
  Device device_;
  Outcome outcome_;
};

TEST_F(QualityGate, CleanShot_Passes) {
  judge(device_, Limits(), outcome_);
  EXPECT_EQ(outcome_.verdict, Verdict::kPass);
  EXPECT_TRUE(outcome_.reasons.empty());
}

TEST_F(QualityGate, NumbersThatAreNone_NeverPass) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  cam1().cov_rig_cam(2, 2) = kNan;
  judge(device_, Limits(), outcome_);
  EXPECT_EQ(outcome_.verdict, Verdict::kFailRetry);
  cam1().cov_rig_cam = Mat66::Identity() * 1e-10;
  cam1().T_rig_cam.t.y() = kNan;
  judge(device_, Limits(), outcome_);
  EXPECT_EQ(outcome_.verdict, Verdict::kFailService);
  cam1().T_rig_cam.t.y() = 0;
  outcome_.solution.chi2 = kNan;
  judge(device_, Limits(), outcome_);
  EXPECT_EQ(outcome_.verdict, Verdict::kFailService);
}

TEST_F(QualityGate, UncertainExtrinsic_BlamesAMapThatIsNoBetter) {
  cam1().cov_rig_cam = Mat66::Identity() * 16e-6;
  expect(Verdict::kFailRetry, "0.050 deg: move the device");
  std::array<rig::Landmark, 3> landmarks{};
  outcome_.landmarks = landmarks;
  for (rig::Landmark& landmark : landmarks) landmark.cov_m2 = 2.9e-3 * 2.9e-3 * Mat33::Identity();
  expect(Verdict::kFailRetry, "0.050 deg: move the device");
  for (rig::Landmark& landmark : landmarks) landmark.cov_m2 = 1e-4 * Mat33::Identity();
  expect(Verdict::kFailRetry, "survey the room again, its map is good to 10.0 mm only, or move");
}

TEST_F(QualityGate, DetectorsTablesFull_IsSaid) {
  cam1().detections_complete = false;
  expect(Verdict::kPassAdvise, "cam1: more ring-like shapes");
}

TEST_F(QualityGate, CameraNotLocatedForAReasonOfItsOwn_AsksForService) {
  cam1().located = cam1().in_rig = false;
  cam1().failure = "cam1: its rings look 1.20 times as large";
  cam1().failure_verdict = Verdict::kFailService;
  expect(Verdict::kFailService, "cam1: its rings");
}

TEST_F(QualityGate, CameraNotLocated_FailsWithItsReason) {
  cam1().located = cam1().in_rig = false;
  cam1().failure = "cam1: no image: check its cable and driver";
  expect(Verdict::kFailRetry, "cam1: no image");
}

TEST_F(QualityGate, ManyUnexplainedMarkers_FailForService) {
  cam1().usable_detections = 40;
  expect(Verdict::kFailService, "cam1: 50 % of its 40 markers");
}

TEST_F(QualityGate, FewInliers_Advise) {
  cam1().inliers = cam1().inliers.first(7);
  cam1().usable_detections = 7;
  expect(Verdict::kPassAdvise, "cam1: only 7 markers");
}

TEST_F(QualityGate, CrowdedMarkers_Advise) {
  cam1().coverage = 0.1;
  expect(Verdict::kPassAdvise, "cam1: markers fill only 10 %");
}

TEST_F(QualityGate, LooseCovariance_FailsForRetry) {
  cam1().cov_rig_cam(1, 1) = 1e-4;
  expect(Verdict::kFailRetry, "cam1: 1-sigma of 10.00 mm");
}

TEST_F(QualityGate, FarFromNominal_FailsForService) {
  cam1().T_rig_cam.t.y() = 0.05;
  expect(Verdict::kFailService, "cam1: sits 50.");
}

TEST_F(QualityGate, PoorFit_AdvisesThenFailsByTheWorstCamerasName) {
  std::array<rig::RingObservation, 20> rings{};
  std::array<double, 2> chi2 = {100, 400};
  for (std::size_t i = 0; i < 2; ++i) {
    outcome_.cameras[i].rings = rings;
    outcome_.cameras[i].view = i;
  }
  outcome_.solution.chi2_camera = chi2;
  outcome_.solution.chi2 = 500;
  expect(Verdict::kPassAdvise, "cam1: fits worst of a joint solution");
  outcome_.solution.chi2 = 5000;
  expect(Verdict::kFailService, "cam1: fits worst of a joint solution");
}

TEST_F(QualityGate, HeldOutMarkersMissed_AdviseThenFailByTheWorstCamerasName) {
  outcome_.held_out = {12, 3.0, "cam0"};
  expect(Verdict::kPassAdvise, "cam0: is worst of 12 held-out markers missed by 3.0 sigma");
  outcome_.held_out.median_sigmas = 5;
  expect(Verdict::kFailService, "cam0: is worst of 12 held-out");
}

TEST_F(QualityGate, InstalledSensorThatTheDeviceLacks_IsSaid) {
  SensorChange change;
  change.name = "cam7";
  ASSERT_TRUE(outcome_.installed.sensors.push_back(change));
  expect(Verdict::kPassAdvise, "cam7: is in the installed record but not in this device");
}

TEST_F(QualityGate, RefinedIntrinsicsFarFromTheGivenOnes_AskForService) {
  const camera::Intrinsics k{camera::Model::kPinholeRadtan, 640, 480, 400, 400, 320, 240, {}};
  std::array<rig::RefinedLens, 1> lens;
  lens[0].view = cam1().view = 1;
  lens[0].camera = camera::Camera::create(k).value();
  lens[0].prior = camera::parameters_of(k);
  lens[0].prior_sigma.setConstant(1);
  outcome_.solution.lenses = lens;
  judge(device_, Limits(), outcome_);
  EXPECT_EQ(outcome_.verdict, Verdict::kPass);
  lens[0].prior[2] += 5.5;
  expect(Verdict::kFailService, "cam1: its cx_px comes out 5.5 sigma from what the device says");
}

TEST_F(QualityGate, LimitsOfTheDevice_AreTheOnesThatCount) {
  Limits limits;
  limits.advise_inliers = 21;
  judge(device_, limits, outcome_);
  EXPECT_EQ(outcome_.verdict, Verdict::kPassAdvise);
  EXPECT_EQ(outcome_.reasons.size(), 2U);
}

TEST_F(QualityGate, WorstReason_DecidesTheVerdict) {
  cam1().coverage = 0.1;
  outcome_.cameras[0].usable_detections = 40;
  judge(device_, Limits(), outcome_);
  EXPECT_EQ(outcome_.verdict, Verdict::kFailService);
  EXPECT_EQ(outcome_.reasons.size(), 2u);
}

}  // namespace
}  // namespace roomcal::calib
