#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/calib/preflight.h"

namespace roomcal::calib {
namespace {

LidarSpec vlp16() {
  LidarSpec spec;
  spec.name = "lidar0";
  return spec;
}

/// Returns at 2 m all around, but for `blocked_deg` of the horizon, where something at 0.1 m sends them back.
std::vector<lidar::SweepPoint> turn(double blocked_deg) {
  std::vector<lidar::SweepPoint> points(7200);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double azimuth_rad = 2 * kPi * static_cast<double>(i) / static_cast<double>(points.size());
    const double range_m = rad_to_deg(azimuth_rad) < blocked_deg ? 0.1 : 2;
    points[i].x_m = static_cast<float>(range_m * std::cos(azimuth_rad));
    points[i].y_m = static_cast<float>(range_m * std::sin(azimuth_rad));
  }
  return points;
}

LidarOutcome check(const std::vector<lidar::Sweep>& sweeps) {
  LidarOutcome outcome;
  check_sweeps(vlp16(), sweeps, {}, outcome);
  return outcome;
}

std::string failure(const std::vector<lidar::Sweep>& sweeps) { return std::string(check(sweeps).failure.view()); }

lidar::Sweep sweep_of(const std::vector<lidar::SweepPoint>& points, uint32_t flags = 0) {
  lidar::Sweep sweep;
  sweep.points = points;
  sweep.flags = flags;
  return sweep;
}

TEST(CheckSweeps, NoSweep_NamesTheSensorAndTheCable) {
  EXPECT_EQ(failure({}), "lidar0: no packets: check its power, cable and address");
}

TEST(CheckSweeps, FlaggedSweeps_AreLeftOutAndOneGoodOneIsEnough) {
  const auto points = turn(0);
  const LidarOutcome mixed = check({sweep_of(points, lidar::kSweepPartial), sweep_of(points)});
  EXPECT_TRUE(mixed.failure.empty());
  EXPECT_EQ(mixed.used_sweeps, 1U);
  EXPECT_EQ(mixed.sweeps, 2U);
  EXPECT_NE(failure({sweep_of(points, lidar::kSweepPartial)}).find("no whole turn"), std::string::npos);
  EXPECT_NE(failure({sweep_of(points, lidar::kSweepLostPackets)}).find("packets were lost"), std::string::npos);
  EXPECT_TRUE(failure({sweep_of(points, lidar::kSweepDuplicates)}).empty());
}

TEST(CheckSweeps, BlockedView_IsRefusedWithHowMuch) {
  EXPECT_TRUE(failure({sweep_of(turn(90))}).empty());
  const auto blocked = turn(275);
  EXPECT_EQ(failure({sweep_of(blocked)}),
            "lidar0: 270 degrees of its horizon are blocked: clear its view, or set min_horizon if the "
            "device blocks it");
  LidarOutcome allowed;
  check_sweeps(vlp16(), std::vector<lidar::Sweep>{sweep_of(blocked)}, {.min_horizon = 0.25}, allowed);
  EXPECT_TRUE(allowed.failure.empty());
}

TEST(CheckSweeps, EmptyOrNotANumber_HasNoReturns) {
  std::vector<lidar::SweepPoint> nan(5000);
  for (lidar::SweepPoint& point : nan) point.x_m = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(failure({sweep_of(nan)}).find("only 0 returns"), std::string::npos);
  EXPECT_NE(failure({sweep_of({})}).find("only 0 returns"), std::string::npos);
}

}  // namespace
}  // namespace roomcal::calib
