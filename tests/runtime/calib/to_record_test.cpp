#include "runtime/calib/to_record.h"

#include <memory>

#include <gtest/gtest.h>

namespace roomcal::calib {
namespace {

class ToRecord : public testing::Test {
 protected:
  void SetUp() override {
    camera::Intrinsics k{camera::Model::kPinholeRadtan, 640, 480, 400, 401, 320, 240, {-0.1, 0.01, 0, 0}};
    for (const char* name : {"left", "right", "back"}) {
      ASSERT_TRUE(device->cameras.push_back({name, camera::Camera::create(k).value(), {}}));
      k.fx_px += 1;
      CameraOutcome camera;
      camera.camera = device->cameras.back().camera;
      camera.name = name;
      camera.located = camera.in_rig = true;
      camera.usable_detections = 20;
      camera.rms_px = 0.05;
      ASSERT_TRUE(outcome->cameras.push_back(camera));
    }
    device->reference = outcome->reference = 1;
    outcome->verdict = Verdict::kPass;
    for (const std::size_t i : {0U, 2U}) {
      outcome->cameras[i].T_rig_cam.t = Vec3(0.1, 0.2, static_cast<double>(i));
      outcome->cameras[i].cov_rig_cam = 1e-8 * Mat66::Identity();
    }
  }

  std::unique_ptr<Device> device = std::make_unique<Device>();
  std::unique_ptr<Outcome> outcome = std::make_unique<Outcome>();
  std::unique_ptr<store::Record> record = std::make_unique<store::Record>();
};

TEST_F(ToRecord, PassedOutcome_KeepsPosesIntrinsicsAndContext) {
  RecordContext context;
  context.map_id = "hall";
  context.map_hash = 7;
  device->cameras[2].serial = "S-2";
  context.device_serial = "d1";
  ASSERT_TRUE(to_record(*outcome, *device, context, *record).ok());
  ASSERT_EQ(record->sensors.size(), 3U);
  EXPECT_EQ(record->reference, 1U);
  EXPECT_EQ(record->sensors[2].T_rig_sensor.t, Vec3(0.1, 0.2, 2));
  EXPECT_EQ(record->sensors[2].intrinsics.fx_px, 402);
  EXPECT_EQ(record->sensors[0].evidence.detections, 20U);
  EXPECT_EQ(record->sensors[2].serial.view(), "S-2");
  EXPECT_TRUE(record->sensors[0].serial.empty());
  EXPECT_EQ(record->map_id.view(), "hall");
  EXPECT_EQ(record->verdict, Verdict::kPass);
}

TEST_F(ToRecord, RefinedIntrinsics_AreWhatTheRecordKeeps) {
  camera::Intrinsics refined = outcome->cameras[2].camera.intrinsics();
  refined.fx_px = 403.5;
  outcome->cameras[2].camera = camera::Camera::create(refined).value();
  ASSERT_TRUE(to_record(*outcome, *device, {}, *record).ok());
  EXPECT_EQ(record->sensors[2].intrinsics.fx_px, 403.5);
  EXPECT_EQ(record->sensors[0].intrinsics.fx_px, 400);
}

TEST_F(ToRecord, CameraThatWasNotLocated_IsNotInTheRecord) {
  outcome->cameras[0].in_rig = false;
  ASSERT_TRUE(to_record(*outcome, *device, {}, *record).ok());
  ASSERT_EQ(record->sensors.size(), 2U);
  EXPECT_EQ(record->find("left"), nullptr);
  EXPECT_EQ(record->sensors[record->reference].name.view(), "right");
}

TEST_F(ToRecord, ReferenceNotLocated_IsNotFound) {
  outcome->cameras[1].in_rig = false;
  EXPECT_EQ(to_record(*outcome, *device, {}, *record).code(), StatusCode::kNotFound);
}

TEST_F(ToRecord, PoseNeverSet_IsRefusedInsteadOfStoredAsIdentity) {
  outcome->cameras[2].T_rig_cam = SE3();
  EXPECT_EQ(to_record(*outcome, *device, {}, *record).code(), StatusCode::kCorrupt);
}

TEST_F(ToRecord, OutcomeOfAnotherDevice_IsInvalidArgument) {
  outcome->cameras.pop_back();
  EXPECT_EQ(to_record(*outcome, *device, {}, *record).code(), StatusCode::kInvalidArgument);
}

TEST_F(ToRecord, ManyReasons_AreCounted) {
  for (int i = 0; i < 12; ++i) ASSERT_TRUE(outcome->reasons.push_back("look"));
  ASSERT_TRUE(to_record(*outcome, *device, {}, *record).ok());
  ASSERT_EQ(record->reasons.size(), store::kMaxReasons);
  EXPECT_EQ(record->reasons.back().view(), "and 5 more reasons");
}

}  // namespace
}  // namespace roomcal::calib
