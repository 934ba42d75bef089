#include "tools/provision/factory_record.h"

#include <gtest/gtest.h>

#include "tests/runtime/profile/sample_profile.h"
#include "tests/runtime/store/sample_record.h"
#include "tests/tools/refusal.h"

namespace roomcal::tools {
namespace {

using profile::test::full_profile;
using store::test::sample_record;
using test::refusal;

/// A device of the sensors of sample_record(seed, 2, 1): cam0 (the reference), cam1, lidar0.
profile::Profile measured_device() {
  profile::Profile profile = full_profile();
  profile.reference = 0;
  profile.cameras[0].nominal = {};
  return profile;
}

std::string refusal_of(const profile::Profile& profile, const store::Record& record) {
  return refusal([&] { static_cast<void>(factory_record(profile, record, "m.record")); });
}

TEST(FactoryRecord, ByTheDrawing_HoldsEverySensorWhoseMountingIsKnown) {
  profile::Profile profile = full_profile();
  profile.cameras[2].nominal = {};
  const store::Record record = factory_record(profile);
  ASSERT_TRUE(check_record(record).ok()) << check_record(record).detail();
  ASSERT_EQ(record.sensors.size(), 5U);  // cam0, cam1 (the reference), the LiDARs
  EXPECT_EQ(record.find("cam2"), nullptr);
  EXPECT_EQ(record.reference, 1U);
  EXPECT_EQ(record.action, store::Action::kProvisioned);
  EXPECT_EQ(record.generation, store::kFactoryContent);
  EXPECT_EQ(record.verdict, Verdict::kPassAdvise);
  EXPECT_EQ(record.device_serial.view(), "RB-0042");
  EXPECT_EQ(record.measured_unix_s, 0);  // nobody measured
  const store::SensorRecord& reference = record.sensors[1];
  EXPECT_EQ(reference.name.view(), "cam1");
  EXPECT_EQ(reference.cov_rig_sensor, Mat66::Zero());
  EXPECT_EQ(reference.intrinsics.fx_px, 612.25);
  const store::SensorRecord& lidar = *record.find("lidar1");
  EXPECT_EQ(lidar.kind, store::SensorKind::kLidar);
  EXPECT_EQ(lidar.model.view(), "os1");
  EXPECT_EQ(lidar.serial.view(), "L-7502");
  EXPECT_EQ(lidar.T_rig_sensor.t, profile.lidars[1].nominal.T_rig_sensor.t);
  EXPECT_NEAR(lidar.cov_rig_sensor(0, 0), 0.005 * 0.005, 1e-15);
  EXPECT_NEAR(lidar.cov_rig_sensor(5, 5), 0.02 * 0.02, 1e-15);
}

TEST(FactoryRecord, WithoutAnyMounting_IsTheReferenceAlone) {
  const store::Record record = factory_record(profile::test::small_profile());
  ASSERT_TRUE(check_record(record).ok());
  ASSERT_EQ(record.sensors.size(), 1U);
  EXPECT_EQ(record.sensors[0].name.view(), "cam0");
}

TEST(FactoryRecord, Measured_KeepsWhatWasMeasuredAndTakesTheDevicesSerials) {
  store::Record measured = sample_record(4, 2, 1);
  for (store::SensorRecord& sensor : measured.sensors) sensor.serial.clear();  // as the host measured
  measured.sensors[1].serial = "C-1";
  measured.generation = measured.content_generation = 7;
  measured.action = store::Action::kCalibrated;
  const store::Record record = factory_record(measured_device(), measured, "m.record");
  ASSERT_TRUE(check_record(record).ok());
  EXPECT_EQ(record.sensors[1].T_rig_sensor.t, measured.sensors[1].T_rig_sensor.t);
  EXPECT_EQ(record.measured_unix_s, measured.measured_unix_s);
  EXPECT_EQ(record.verdict, measured.verdict);
  EXPECT_EQ(record.action, store::Action::kProvisioned);
  EXPECT_EQ(record.generation, 0U);
  EXPECT_EQ(record.content_generation, 0U);
  EXPECT_EQ(record.previous_content, store::kNothingBefore);
  EXPECT_EQ(record.device_serial.view(), "RB-0042");
  EXPECT_EQ(record.sensors[0].serial.view(), "C-0");
  EXPECT_EQ(record.sensors[1].serial.view(), "C-1");
  EXPECT_EQ(record.sensors[2].serial.view(), "L-2368");
}

TEST(FactoryRecord, MeasuredWithSomethingElse_IsRefusedByName) {
  store::Record other = sample_record(4, 2, 1);
  for (store::SensorRecord& sensor : other.sensors) sensor.serial.clear();
  const store::Record good = other;
  EXPECT_EQ(refusal_of(measured_device(), good), "");

  other.verdict = Verdict::kFailRetry;
  EXPECT_EQ(refusal_of(measured_device(), other), "m.record: its verdict is FAIL_RETRY; a factory record has passed");
  other = good;
  other.sensors[1].name = "rear";
  EXPECT_EQ(refusal_of(measured_device(), other), "m.record: rear is not a sensor of robot 7; is it another device's?");
  other = good;
  other.sensors[1].name = "lidar1";  // a camera of a LiDAR's name
  EXPECT_EQ(refusal_of(measured_device(), other),
            "m.record: lidar1 is not a sensor of robot 7; is it another device's?");
  other = good;
  other.sensors[1].serial = "C-9";
  EXPECT_EQ(refusal_of(measured_device(), other),
            "m.record: cam1 had serial C-9 when it was measured and has C-1 now; calibrate again");
  EXPECT_EQ(refusal_of(full_profile(), good),
            "m.record: its reference is cam0, this device's is cam1; calibrate with this device.yaml");
}

}  // namespace
}  // namespace roomcal::tools
