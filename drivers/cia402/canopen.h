#pragma once

#include <cstdint>
#include <span>

#include "runtime/ports/can_bus.h"

namespace roomcal::drivers::cia402 {

// The part of CANopen that a servo needs. Source: CiA 301 version 4.2, chapters 7.2 (NMT, SYNC, EMCY, PDO, SDO) and
// 7.3.3 (predefined connection set).

inline constexpr uint8_t kMaxNode = 127;
inline constexpr uint32_t kNmtId = 0x000, kSyncId = 0x080;
constexpr uint32_t emergency_id(uint8_t node) { return 0x080U + node; }
constexpr uint32_t tpdo1_id(uint8_t node) { return 0x180U + node; }
constexpr uint32_t rpdo1_id(uint8_t node) { return 0x200U + node; }
constexpr uint32_t sdo_answer_id(uint8_t node) { return 0x580U + node; }
constexpr uint32_t sdo_request_id(uint8_t node) { return 0x600U + node; }
constexpr uint32_t heartbeat_id(uint8_t node) { return 0x700U + node; }

enum class NmtCommand : uint8_t {
  kStart = 0x01,
  kStop = 0x02,
  kEnterPreOperational = 0x80,
  kResetNode = 0x81,
  kResetCommunication = 0x82,
};
enum class NmtState : uint8_t {
  kBootUp = 0x00,
  kStopped = 0x04,
  kOperational = 0x05,
  kPreOperational = 0x7F,
};

/// Little-endian numbers of one to four bytes.
uint32_t le(std::span<const uint8_t> bytes);
void put_le(uint32_t value, std::span<uint8_t> bytes);

ports::CanMessage nmt_message(NmtCommand command, uint8_t node);
ports::CanMessage sync_message();
ports::CanMessage heartbeat_message(uint8_t node, NmtState state);

/// @return false if the message is not one byte long.
bool read_heartbeat(const ports::CanMessage& message, NmtState& state);

/// Something is wrong with a node, or no longer.
struct Emergency {
  uint16_t code = 0;  ///< 0: an earlier one is over
  uint8_t error_register = 0;
};
/// @return false if the message is not eight bytes long.
bool read_emergency(const ports::CanMessage& message, Emergency& emergency);
/// "following error", "current", ... of a code of CiA 301, table 26, or CiA 402. Never null.
const char* emergency_name(uint16_t code);

}  // namespace roomcal::drivers::cia402
