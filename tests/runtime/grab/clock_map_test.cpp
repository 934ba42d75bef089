#include "runtime/grab/clock_map.h"

#include <gtest/gtest.h>

#include "tests/fakes/manual_clocks.h"
#include "tests/truth/random.h"

namespace roomcal::grab {
namespace {

constexpr int64_t kMs = 1'000'000;

class ClockMapTest : public testing::Test {
 protected:
  ImageTime map(const Stamp& stamp, int64_t arrived_ns) { return map_.to_monotonic(stamp, 7, arrived_ns, clocks_); }

  fakes::ManualClocks clocks_;
  ClockMap map_{40 * kMs};
};

TEST_F(ClockMapTest, Monotonic_IsTakenAsItIs) {
  const ImageTime time = map({123, ClockId::kMonotonic}, 500);
  EXPECT_EQ(time.exposed_ns, 123);
  EXPECT_EQ(time.uncertainty_ns, 7);
}

TEST_F(ClockMapTest, Realtime_IsBroughtOver) {
  const int64_t exposed_ns = clocks_.now_ns();
  const Stamp stamp = clocks_.read(ClockId::kRealtime);
  clocks_.advance(30 * kMs);
  const ImageTime time = map(stamp, clocks_.now_ns());
  EXPECT_EQ(time.exposed_ns, exposed_ns);
  EXPECT_LE(time.uncertainty_ns, 10);
}

TEST_F(ClockMapTest, RealtimeSetDuringAGrab_IsCountedAndTheStampSaysSo) {
  map(clocks_.read(ClockId::kRealtime), clocks_.now_ns());
  const Stamp before_step = clocks_.read(ClockId::kRealtime);
  clocks_.advance(10 * kMs);
  clocks_.step_realtime(3'600'000 * kMs);
  const ImageTime time = map(before_step, clocks_.now_ns());
  EXPECT_EQ(map_.steps(), 1U);
  EXPECT_GE(time.uncertainty_ns, 3'600'000 * kMs);
  const ImageTime after = map(clocks_.read(ClockId::kRealtime), clocks_.now_ns());
  EXPECT_EQ(after.exposed_ns, clocks_.now_ns());
  EXPECT_LE(after.uncertainty_ns, 10) << "the next stamp is of the new time already";
  EXPECT_EQ(map_.steps(), 1U);
}

TEST_F(ClockMapTest, SlewedRealtime_IsNoStep) {
  for (int i = 0; i < 100; ++i) {
    clocks_.advance(33 * kMs);
    clocks_.step_realtime(16'000);  // 500 ppm
    EXPECT_LE(map(clocks_.read(ClockId::kRealtime), clocks_.now_ns()).uncertainty_ns, 10);
  }
  EXPECT_EQ(map_.steps(), 0U);
}

TEST_F(ClockMapTest, DeviceClock_IsRelatedByItsQuickestImages) {
  truth::Random random(4);
  for (int i = 0; i < 200; ++i) {
    clocks_.advance(33 * kMs);
    const int64_t exposed_ns = clocks_.now_ns();
    const auto delay_ns = static_cast<int64_t>((12 + 3 * random.uniform(0, 1)) * kMs);
    const ImageTime time = map({exposed_ns - 5'000'000'000, ClockId::kDevice}, exposed_ns + delay_ns);
    // What the quickest image takes stays unknown: 12 ms late, and beyond that within what it claims.
    EXPECT_NEAR(static_cast<double>(time.exposed_ns - exposed_ns), 12.0 * kMs, 3.0 * kMs);
    EXPECT_LE(time.uncertainty_ns, 3 * kMs + 7);
  }
  EXPECT_EQ(map_.steps(), 0U);
}

TEST_F(ClockMapTest, DeviceClockDrifting100Ppm_IsFollowed) {
  for (int i = 0; i < 2000; ++i) {
    clocks_.advance(33 * kMs);
    const int64_t exposed_ns = clocks_.now_ns();
    const ImageTime time = map({exposed_ns + exposed_ns / 10'000, ClockId::kDevice}, exposed_ns + 12 * kMs);
    EXPECT_NEAR(static_cast<double>(time.exposed_ns - exposed_ns), 12.0 * kMs, 1.0 * kMs) << i;
  }
}

TEST_F(ClockMapTest, DeviceClockRestarting_IsAStepAndThenFine) {
  map({clocks_.now_ns(), ClockId::kDevice}, clocks_.now_ns() + 12 * kMs);
  clocks_.advance(33 * kMs);
  const ImageTime at_step = map({5 * kMs, ClockId::kDevice}, clocks_.now_ns() + 12 * kMs);
  EXPECT_GE(at_step.uncertainty_ns, 40 * kMs);
  EXPECT_EQ(map_.steps(), 1U);
  clocks_.advance(33 * kMs);
  const ImageTime after = map({38 * kMs, ClockId::kDevice}, clocks_.now_ns() + 12 * kMs);
  EXPECT_LE(after.uncertainty_ns, 1 * kMs);
}

TEST_F(ClockMapTest, UnknownClock_OnlyTheArrivalCounts) {
  const ImageTime time = map({77, ClockId::kUnknown}, 1000 * kMs);
  EXPECT_LE(std::abs(time.exposed_ns - 1000 * kMs), time.uncertainty_ns);
  EXPECT_EQ(time.uncertainty_ns, 20 * kMs);
}

}  // namespace
}  // namespace roomcal::grab
