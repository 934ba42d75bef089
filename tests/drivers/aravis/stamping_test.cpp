#include "drivers/aravis/stamping.h"

#include <gtest/gtest.h>

#include "tests/fakes/manual_clocks.h"

namespace roomcal::drivers {
namespace {

constexpr int64_t kMs = 1'000'000;
constexpr int64_t kS = 1'000'000'000;

class StampingTest : public testing::Test {
 protected:
  // An image whose first packet came 3 ms ago.
  ImageStamp stamp(int64_t camera_ahead_ns, const StampContext& context) const {
    const int64_t host_ns = clocks_.read(ClockId::kRealtime).ns - 3 * kMs;
    return stamp_of({host_ns + camera_ahead_ns, host_ns}, context, clocks_);
  }
  static StampContext context(PtpState ptp, StampPoint point = StampPoint::kExposureStart) {
    return {true, ptp, point, 10 * kMs};
  }

  fakes::ManualClocks clocks_;
};

TEST_F(StampingTest, Arrival_IsMonotonic) {
  EXPECT_EQ(stamp(0, context(PtpState::kNone)).arrived_ns, clocks_.now_ns() - 3 * kMs);
}

TEST_F(StampingTest, ClockThatWasSetMeanwhile_LeavesTheArrivalInBounds) {
  const int64_t host_ns = clocks_.read(ClockId::kRealtime).ns;
  clocks_.step_realtime(-3600 * kS);
  EXPECT_EQ(stamp_of({1, host_ns}, context(PtpState::kNone), clocks_).arrived_ns, clocks_.now_ns());
  clocks_.step_realtime(7200 * kS);
  EXPECT_EQ(stamp_of({1, host_ns}, context(PtpState::kNone), clocks_).arrived_ns, clocks_.now_ns() - 10 * kS);
}

TEST_F(StampingTest, WithoutPtp_EvenTheRightTimeIsTheCamerasOwn) {
  for (const PtpState ptp : {PtpState::kNone, PtpState::kOff, PtpState::kConverging, PtpState::kFaulty})
    EXPECT_EQ(stamp(0, context(ptp)).exposed.clock, ClockId::kDevice);
}

TEST_F(StampingTest, LockedCamera_IsOnTheClockThatItAgreesWith) {
  for (const PtpState ptp : {PtpState::kSlave, PtpState::kMaster}) {
    EXPECT_EQ(stamp(-20 * kMs, context(ptp)).exposed.clock, ClockId::kRealtime);
    EXPECT_EQ(stamp(37 * kS - 20 * kMs, context(ptp)).exposed.clock, ClockId::kTai);
    EXPECT_EQ(stamp(-1'000'000 * kS, context(ptp)).exposed.clock, ClockId::kDevice) << "an epoch of its own";
  }
}

TEST_F(StampingTest, UnknownTickRate_IsTheArrivalAndSaysHowUncertain) {
  StampContext unknown = context(PtpState::kSlave);
  unknown.ticks_known = false;
  const ImageStamp got = stamp(0, unknown);
  EXPECT_EQ(got.exposed.clock, ClockId::kMonotonic);
  // Exposure and readout lie before the arrival: 10 ms and up to 50 ms.
  EXPECT_EQ(got.exposed.ns - got.uncertainty_ns, got.arrived_ns - 60 * kMs);
  EXPECT_EQ(got.exposed.ns + got.uncertainty_ns, got.arrived_ns - 10 * kMs);
}

TEST_F(StampingTest, PointOfTheStamp_DecidesStartAndUncertainty) {
  const int64_t camera_ns = clocks_.read(ClockId::kRealtime).ns - 3 * kMs;
  const ImageStamp start = stamp(0, context(PtpState::kNone, StampPoint::kExposureStart));
  EXPECT_EQ(start.exposed.ns, camera_ns);
  EXPECT_LE(start.uncertainty_ns, 1000);
  const ImageStamp end = stamp(0, context(PtpState::kNone, StampPoint::kExposureEnd));
  EXPECT_EQ(end.exposed.ns, camera_ns - 10 * kMs);
  EXPECT_LE(end.uncertainty_ns, 1000);
  const ImageStamp middle = stamp(0, context(PtpState::kNone, StampPoint::kExposureMiddle));
  EXPECT_EQ(middle.exposed.ns, camera_ns - 5 * kMs);
  EXPECT_LE(middle.uncertainty_ns, 1000);
  const ImageStamp anywhere = stamp(0, context(PtpState::kNone, StampPoint::kUnknown));
  EXPECT_LE(anywhere.exposed.ns - anywhere.uncertainty_ns, end.exposed.ns);
  EXPECT_GE(anywhere.exposed.ns + anywhere.uncertainty_ns, start.exposed.ns);
}

uint32_t step(uint64_t from, uint64_t to) {
  BlockNumbers numbers;
  const uint32_t before = numbers.next(from);
  return numbers.next(to) - before;
}

TEST(BlockNumbers, SixteenBitsWrapPastZero) {
  EXPECT_EQ(step(65'534, 65'535), 1U);
  EXPECT_EQ(step(65'535, 1), 1U);
  EXPECT_EQ(step(65'535, 3), 3U);
  EXPECT_EQ(step(65'000, 10), 545U);
}

TEST(BlockNumbers, SixtyFourBits_CountOn) {
  EXPECT_EQ(step(65'535, 65'536), 1U);
  EXPECT_EQ(step(0, 1), 1U);
  EXPECT_EQ(step((uint64_t{1} << 32U) - 1, uint64_t{1} << 32U), 1U);
  EXPECT_EQ(step(uint64_t{1} << 40U, (uint64_t{1} << 40U) + 7), 7U);
}

TEST(BlockNumbers, Backwards_StaysBackwards) {
  EXPECT_EQ(step(100, 99), static_cast<uint32_t>(-1));
  EXPECT_EQ(step(100'000, 99'990), static_cast<uint32_t>(-10));
}

TEST(PtpState, WordsOfTheStandard_AreKnown) {
  EXPECT_EQ(ptp_state_of("Slave"), PtpState::kSlave);
  EXPECT_EQ(ptp_state_of("Master"), PtpState::kMaster);
  EXPECT_EQ(ptp_state_of("Disabled"), PtpState::kOff);
  EXPECT_EQ(ptp_state_of("Faulty"), PtpState::kFaulty);
  for (const char* word : {"Initializing", "Listening", "PreMaster", "Uncalibrated", "Passive"})
    EXPECT_EQ(ptp_state_of(word), PtpState::kConverging) << word;
}

}  // namespace
}  // namespace roomcal::drivers
