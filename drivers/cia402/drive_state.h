#pragma once

#include <cstdint>

namespace roomcal::drivers::cia402 {

/// States of a drive. Source: CiA 402-2 (IEC 61800-7-201), "Power drive system state machine", statusword 6041h.
enum class DriveState : uint8_t {
  kNotReady,
  kSwitchOnDisabled,
  kReadyToSwitchOn,
  kSwitchedOn,
  kOperationEnabled,
  kQuickStopActive,
  kFaultReaction,
  kFault,
  kUnknown,  ///< a statusword of no state
};
DriveState drive_state(uint16_t statusword);
/// "operation enabled", ... Never null.
const char* to_string(DriveState state);

// Controlword 6040h.
inline constexpr uint16_t kDisableVoltage = 0x0000, kQuickStop = 0x0002, kShutdown = 0x0006, kSwitchOn = 0x0007,
                          kEnableOperation = 0x000F, kFaultReset = 0x0080, kStartHoming = 0x0010;

// Statusword bits beyond the state; 12 and 13 mean what the mode says.
inline constexpr uint16_t kTargetReached = 1U << 10;
inline constexpr uint16_t kHomingAttained = 1U << 12, kHomingError = 1U << 13;  ///< homing mode
inline constexpr uint16_t kStandsStill = 1U << 12, kSlips = 1U << 13;           ///< profile velocity mode

/// The command that brings a drive one state nearer to operation. Nothing helps while it is not ready or reacts to a
/// fault, and a fault wants a reset: then it is kDisableVoltage.
uint16_t command_towards_operation(DriveState state);

/// Modes of operation, object 6060h, and their bits in 6502h.
enum class Mode : int8_t { kProfileVelocity = 3, kHoming = 6 };
constexpr uint32_t supports(Mode mode) { return 1U << (static_cast<int>(mode) - 1); }

}  // namespace roomcal::drivers::cia402
