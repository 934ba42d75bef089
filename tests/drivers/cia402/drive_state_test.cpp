#include "drivers/cia402/drive_state.h"

#include <map>

#include <gtest/gtest.h>

namespace roomcal::drivers::cia402 {
namespace {

// CiA 402-2, table "Statusword bits": x of every pattern may be anything.
TEST(DriveState, EveryStatusword_IsInTheStateOfItsPattern) {
  std::map<DriveState, int> seen;
  for (unsigned word = 0; word <= 0xFFFF; ++word) {
    const unsigned low = word & 0x0F, quick = word >> 5 & 1, off = word >> 6 & 1;
    DriveState expected = DriveState::kUnknown;
    if (low == 0 && off == 0) expected = DriveState::kNotReady;
    if (low == 0 && off == 1) expected = DriveState::kSwitchOnDisabled;
    if (low == 1 && off == 0 && quick == 1) expected = DriveState::kReadyToSwitchOn;
    if (low == 3 && off == 0 && quick == 1) expected = DriveState::kSwitchedOn;
    if (low == 7 && off == 0) expected = quick == 1 ? DriveState::kOperationEnabled : DriveState::kQuickStopActive;
    if (low == 15 && off == 0) expected = DriveState::kFaultReaction;
    if (low == 8 && off == 0) expected = DriveState::kFault;
    ASSERT_EQ(drive_state(static_cast<uint16_t>(word)), expected) << word;
    ++seen[expected];
  }
  EXPECT_EQ(seen.size(), 9U);
}

TEST(DriveState, Commands_LeadToOperationByEveryState) {
  EXPECT_EQ(command_towards_operation(DriveState::kSwitchOnDisabled), 0x06);
  EXPECT_EQ(command_towards_operation(DriveState::kReadyToSwitchOn), 0x07);
  EXPECT_EQ(command_towards_operation(DriveState::kSwitchedOn), 0x0F);
  EXPECT_EQ(command_towards_operation(DriveState::kOperationEnabled), 0x0F);
  EXPECT_EQ(command_towards_operation(DriveState::kQuickStopActive), 0x00);
  EXPECT_EQ(command_towards_operation(DriveState::kFault), 0x00);
}

TEST(DriveState, Modes_HaveTheirBits) {
  EXPECT_EQ(supports(Mode::kProfileVelocity), 0x04U);
  EXPECT_EQ(supports(Mode::kHoming), 0x20U);
}

TEST(DriveState, EveryState_HasAName) {
  EXPECT_STREQ(to_string(DriveState::kQuickStopActive), "quick stop active");
  EXPECT_STREQ(to_string(DriveState::kUnknown), "in no state");
}

}  // namespace
}  // namespace roomcal::drivers::cia402
