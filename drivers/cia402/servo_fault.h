#pragma once

#include <cstdint>

#include "drivers/cia402/drive_state.h"
#include "drivers/cia402/sdo.h"
#include "runtime/base/fixed_text.h"

namespace roomcal::drivers::cia402 {

/// Where a servo stands, in the order of its start.
enum class ServoStep : uint8_t {
  kOff,
  kReset,           ///< the node boots
  kIdentify,        ///< is it a drive, and has it the modes
  kConfigure,       ///< set-up by SDO
  kStart,           ///< NMT start; first heartbeat and position
  kEnable,          ///< fault reset and the way to operation enabled
  kSelectHoming,    ///< mode of operation
  kHome,            ///< looks for its zero
  kSelectVelocity,  ///< mode of operation
  kReady,           ///< holds its place
  kTurn,            ///< turns
  kStop,            ///< slows down
  kPowerOff,        ///< on its way to off
  kFaulted,         ///< told to stop at every SYNC, until power_on() or power_off()
  kCount
};
/// "homing", "turning", ... Never null.
const char* to_string(ServoStep step);

enum class ServoFault : uint8_t {
  kNone,
  kBusDown,
  kNoBoot,
  kNotADrive,
  kNoSuchMode,
  kSdoTimeout,
  kSdoAbort,
  kNotStarted,
  kNoPosition,  ///< SYNC is answered by none
  kSyncLost,    ///< our SYNC does not get onto the bus
  kHeartbeatLost,
  kRebooted,
  kLeftOperation,  ///< of NMT: another master stopped it
  kNotEnabled,
  kDriveFault,
  kDisabled,  ///< it left operation enabled without a fault
  kModeRefused,
  kHomingFailed,
  kHomingTimeout,
  kFollowingError,
  kEmergency,
  kNotStopped,
  kCount
};
/// "heartbeat lost", ... Never null.
const char* to_string(ServoFault fault);

/// What is known of a fault besides its kind.
struct FaultFacts {
  ServoFault fault = ServoFault::kNone;
  ServoStep step = ServoStep::kOff;  ///< in which it came
  uint16_t emergency = 0;            ///< the servo's last emergency code; 0: none
  ObjectKey object;                  ///< of kSdoTimeout, kSdoAbort
  uint32_t abort_code = 0;           ///< of kSdoAbort
  DriveState drive = DriveState::kUnknown;
};
/// "servo node 5, turning: heartbeat lost; check its cable and power". Empty for kNone.
Reason explain(uint8_t node, const FaultFacts& facts);

}  // namespace roomcal::drivers::cia402
