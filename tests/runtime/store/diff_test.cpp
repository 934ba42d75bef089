#include "runtime/store/diff.h"

#include <gtest/gtest.h>

#include "tests/runtime/store/sample_record.h"

namespace roomcal::store {
namespace {

using test::sample_record;

TEST(Diff, SameRecord_IsZero) {
  const Record record = sample_record(1, 3, 1);
  const RecordDiff result = diff(record, record);
  EXPECT_TRUE(result.same_reference);
  EXPECT_TRUE(result.same_map);
  ASSERT_EQ(result.sensors.size(), 4U);
  for (const SensorDiff& sensor : result.sensors) {
    EXPECT_NEAR(sensor.distance_m, 0, 1e-15);
    EXPECT_NEAR(sensor.angle_rad, 0, 1e-7);  // acos near 1
    EXPECT_NEAR(sensor.chi2, 0, 1e-9);
  }
  EXPECT_FALSE(result.sensors[0].has_chi2);
  EXPECT_TRUE(result.sensors[1].has_chi2);
}

TEST(Diff, MovedSensor_TellsHowFarAndHowUnlikely) {
  const Record a = sample_record(1);
  Record b = a;
  Vec6 xi;
  xi << 0.003, 0.004, 0, 0, 0, 0.01;
  b.sensors[1].T_rig_sensor = a.sensors[1].T_rig_sensor * se3_exp(xi);
  b.sensors[1].cov_rig_sensor = 1e-6 * Mat66::Identity();
  Record tight = a;
  tight.sensors[1].cov_rig_sensor = Mat66::Zero();
  const SensorDiff moved = diff(tight, b).sensors[1];
  EXPECT_NEAR((moved.xi - xi).norm(), 0, 1e-12);
  EXPECT_NEAR(moved.distance_m, 0.005, 1e-6);
  EXPECT_NEAR(moved.angle_rad, 0.01, 1e-9);
  EXPECT_NEAR(moved.chi2, (9e-6 + 16e-6 + 1e-4) / 1e-6, 1e-6);
}

TEST(Diff, SensorsOnOneSide_AreListed) {
  const Record a = sample_record(1, 3), b = sample_record(1, 2, 1);
  const RecordDiff result = diff(a, b);
  ASSERT_EQ(result.sensors.size(), 4U);
  EXPECT_TRUE(result.sensors[2].in_a && !result.sensors[2].in_b);
  EXPECT_TRUE(!result.sensors[3].in_a && result.sensors[3].in_b);
  EXPECT_EQ(result.sensors[3].name.view(), "lidar0");
}

TEST(Diff, OtherReference_IsNotCompared) {
  const Record a = sample_record(1);
  Record b = a;
  std::swap(b.sensors[0].name, b.sensors[1].name);
  const RecordDiff result = diff(a, b);
  EXPECT_FALSE(result.same_reference);
  for (const SensorDiff& sensor : result.sensors) EXPECT_FALSE(sensor.in_a && sensor.in_b);
}

TEST(Diff, OtherMap_IsSaid) {
  Record b = sample_record(1);
  b.map_hash ^= 1U;
  EXPECT_FALSE(diff(sample_record(1), b).same_map);
}

}  // namespace
}  // namespace roomcal::store
