#include "drivers/can/signal.h"

#include <limits>

#include <gtest/gtest.h>

#include "drivers/can/roomcal_dbc_generated.h"

namespace roomcal::drivers {
namespace {

constexpr Signal kShifted{"Shifted", 6, 12, true, 0.5, 100, -900, 1100, "", {}};

TEST(Signal, NeighbouringBits_AreLeftAlone) {
  ports::CanMessage message;
  message.data.fill(0xFF);
  put_raw(kShifted, 0, message);
  EXPECT_EQ(message.data[0], 0x3F);
  EXPECT_EQ(message.data[1], 0x00);
  EXPECT_EQ(message.data[2], 0xFC);
  EXPECT_EQ(message.data[3], 0xFF);
}

TEST(Signal, BeyondItsLimits_IsRefusedAndChangesNothing) {
  ports::CanMessage message;
  message.data.fill(0xA5);
  const ports::CanMessage before = message;
  for (const double value : {-900.3, 1100.3, 1e300, -1e300, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(put(kShifted, value, message).code(), StatusCode::kOutOfRange) << value;
    EXPECT_EQ(message.data, before.data);
  }
}

TEST(Signal, ValueReadFromAMessage_CanBePutAgain) {
  ports::CanMessage message = blank(dbc::cal_result::kLayout), again = message;
  for (int64_t raw = 0; raw < 1 << 14; ++raw) {
    put_raw(dbc::cal_result::kRms, raw, message);
    ASSERT_TRUE(put(dbc::cal_result::kRms, value_of(dbc::cal_result::kRms, message), again).ok()) << raw;
    ASSERT_EQ(again.data, message.data);
  }
}

TEST(Signal, Clamped_StaysWithinLimits) {
  ports::CanMessage message;
  const auto clamped = [&](double value) {
    put_clamped(kShifted, value, message);
    return value_of(kShifted, message);
  };
  EXPECT_EQ(clamped(1e9), 1100);
  EXPECT_EQ(clamped(-std::numeric_limits<double>::infinity()), -900);
  EXPECT_EQ(clamped(std::numeric_limits<double>::quiet_NaN()), 1100);
  EXPECT_EQ(clamped(7.6), 7.5);
}

TEST(Signal, OtherIdentifierOrLength_IsAnotherMessage) {
  ports::CanMessage message = blank(dbc::veh_motion::kLayout);
  EXPECT_TRUE(is_of(dbc::veh_motion::kLayout, message));
  message.extended = true;
  EXPECT_FALSE(is_of(dbc::veh_motion::kLayout, message));
  message.extended = false;
  message.length = 8;
  EXPECT_FALSE(is_of(dbc::veh_motion::kLayout, message));
}

TEST(Signal, Labels_AreFoundByRawValue) {
  EXPECT_STREQ(label_of(dbc::veh_motion::kSpeed, -32768), "unknown");
  EXPECT_EQ(label_of(dbc::veh_motion::kSpeed, 0), nullptr);
  EXPECT_STREQ(label_of(dbc::cal_status::kStep, static_cast<int64_t>(dbc::cal_status::Step::kWaitStill)), "wait_still");
}

}  // namespace
}  // namespace roomcal::drivers
