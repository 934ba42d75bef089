#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "runtime/base/fixed_vector.h"

/// Datagrams of the GigE Vision control protocol (GVCP), those few that Aravis has no call for. All numbers big-endian:
///
/// | command, bytes    | 0    | 1     | 2..3    | 4..5   | 6..7 | 8..11      | 12..15    | 16..19     | 20..27      |
/// |-------------------|------|-------|---------|--------|------|------------|-----------|------------|-------------|
/// | ACTION_CMD        | 0x42 | flags | 0x0100  | length | id   | device key | group key | group mask | action time |
/// | READREG_CMD       | 0x42 | flags | 0x0080  | 4      | id   | address    |           |            |             |
/// | acknowledgement   | status       | 0x0101, | length | id   | value of READREG_ACK                            |
/// |                   |              | 0x0081  |        |      |                                                 |
///
/// Flags: 0x01 acknowledgement wanted, 0x80 action time present. Source: Wireshark's dissector of GVCP, against which
/// the tests hold these functions.
namespace roomcal::drivers::gvcp {

inline constexpr uint16_t kPort = 3956;
inline constexpr std::size_t kMaxDatagram = 28;
/// Control channel privilege: whether somebody controls the camera, in bits 0 (exclusive) and 1.
inline constexpr uint32_t kControlRegister = 0x0A00;

using Datagram = FixedVector<std::byte, kMaxDatagram>;

/// Which cameras act: those whose device and group keys are equal to these, and whose group mask has a bit in common.
struct ActionCommand {
  uint16_t id = 1;  ///< of the request, not 0
  uint32_t device_key = 0;
  uint32_t group_key = 0;
  uint32_t group_mask = 0;
  bool acknowledge = false;
  std::optional<uint64_t> action_time;  ///< of the cameras' clock; empty: at once
};
Datagram action_command(const ActionCommand& command);
Datagram read_register(uint16_t id, uint32_t address);

enum class Answer : uint16_t { kReadRegister = 0x0081, kAction = 0x0101 };

/// What a camera answers.
enum AckStatus : uint16_t {
  kSuccess = 0,
  kAccessDenied = 0x8006,
  kNoReferenceTime = 0x8013,  ///< it has no clock to schedule by: PTP is off
  kOverflow = 0x8015,         ///< too many scheduled actions
  kActionLate = 0x8016,       ///< the action time was past
};

struct Acknowledgement {
  uint16_t status = 0;  ///< AckStatus, or another code of the standard
  uint16_t id = 0;
  uint32_t value = 0;  ///< of kReadRegister, where `status` is kSuccess
};
/// @return nothing for a datagram that is not such an answer, or is shorter than it says.
std::optional<Acknowledgement> parse_acknowledgement(std::span<const std::byte> datagram, Answer answer);

}  // namespace roomcal::drivers::gvcp
