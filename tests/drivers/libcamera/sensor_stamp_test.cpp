#include "drivers/libcamera/sensor_stamp.h"

#include <gtest/gtest.h>

#include "tests/fakes/manual_clocks.h"

namespace roomcal::drivers {
namespace {

constexpr int64_t kMs = 1'000'000;
constexpr int64_t kS = 1'000'000'000;

// A machine that has slept.
class SleptClocks final : public ports::SystemClocks {
 public:
  explicit SleptClocks(int64_t slept_ns) : slept_ns_(slept_ns) {}
  int64_t now_ns() const override { return 100 * kS; }
  Stamp read(ClockId clock) const override { return {now_ns() + (clock == ClockId::kBoottime ? slept_ns_ : 0), clock}; }
  void sleep_until(int64_t) const override {}

 private:
  int64_t slept_ns_;
};

ClockId clock_of(int64_t stamp_ns, int64_t slept_ns) {
  return sensor_stamp({stamp_ns, 0, 0}, SleptClocks(slept_ns)).exposed.clock;
}

TEST(SensorStamp, MachineThatNeverSlept_HasOneClock) {
  EXPECT_EQ(clock_of(100 * kS - 20 * kMs, 0), ClockId::kMonotonic);
}

TEST(SensorStamp, MachineThatSlept_TellsByTheAge) {
  EXPECT_EQ(clock_of(100 * kS - 20 * kMs, 3600 * kS), ClockId::kMonotonic) << "as most pipelines do";
  EXPECT_EQ(clock_of(3700 * kS - 20 * kMs, 3600 * kS), ClockId::kBoottime) << "as libcamera documents it";
}

TEST(SensorStamp, ShortSleep_IsUncertainByIt) {
  const SensorStamp stamp = sensor_stamp({100 * kS - 20 * kMs, 10 * kMs, 0}, SleptClocks(300 * kMs));
  EXPECT_EQ(stamp.exposed.clock, ClockId::kBoottime);
  EXPECT_GE(stamp.uncertainty_ns, 300 * kMs);
}

TEST(SensorStamp, AgeThatFitsNoClock_IsUnknown) {
  for (const int64_t stamp_ns : {int64_t{0}, 50 * kS, 102 * kS}) EXPECT_EQ(clock_of(stamp_ns, 0), ClockId::kUnknown);
}

TEST(SensorStamp, Exposure_LiesBetweenTheStampAndOneExposureBefore) {
  const int64_t stamp_ns = 100 * kS - 20 * kMs;
  const SensorStamp known = sensor_stamp({stamp_ns, 8 * kMs, 33 * kMs}, SleptClocks(0));
  EXPECT_EQ(known.exposed.ns, stamp_ns - 4 * kMs);
  EXPECT_EQ(known.uncertainty_ns, 5 * kMs);
  const SensorStamp by_period = sensor_stamp({stamp_ns, 0, 33 * kMs}, SleptClocks(0));
  EXPECT_GE(by_period.uncertainty_ns, 33 * kMs / 2);
  const SensorStamp by_nothing = sensor_stamp({stamp_ns, 0, 0}, SleptClocks(0));
  EXPECT_GE(by_nothing.uncertainty_ns, 50 * kMs);
}

}  // namespace
}  // namespace roomcal::drivers
