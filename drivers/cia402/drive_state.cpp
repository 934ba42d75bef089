#include "drivers/cia402/drive_state.h"

#include <array>

namespace roomcal::drivers::cia402 {

namespace {

struct Pattern {
  uint16_t mask, value;
  DriveState state;
  const char* name;
};
constexpr std::array<Pattern, 8> kPatterns{{
    {0x4F, 0x00, DriveState::kNotReady, "not ready"},
    {0x4F, 0x40, DriveState::kSwitchOnDisabled, "switch-on disabled"},
    {0x6F, 0x21, DriveState::kReadyToSwitchOn, "ready to switch on"},
    {0x6F, 0x23, DriveState::kSwitchedOn, "switched on"},
    {0x6F, 0x27, DriveState::kOperationEnabled, "operation enabled"},
    {0x6F, 0x07, DriveState::kQuickStopActive, "quick stop active"},
    {0x4F, 0x0F, DriveState::kFaultReaction, "reacting to a fault"},
    {0x4F, 0x08, DriveState::kFault, "fault"},
}};

}  // namespace

DriveState drive_state(uint16_t statusword) {
  for (const Pattern& pattern : kPatterns)
    if ((statusword & pattern.mask) == pattern.value) return pattern.state;
  return DriveState::kUnknown;
}

const char* to_string(DriveState state) {
  for (const Pattern& pattern : kPatterns)
    if (pattern.state == state) return pattern.name;
  return "in no state";
}

uint16_t command_towards_operation(DriveState state) {
  switch (state) {
    case DriveState::kSwitchOnDisabled:
      return kShutdown;
    case DriveState::kReadyToSwitchOn:
      return kSwitchOn;
    case DriveState::kSwitchedOn:
    case DriveState::kOperationEnabled:
      return kEnableOperation;
    default:
      return kDisableVoltage;
  }
}

}  // namespace roomcal::drivers::cia402
