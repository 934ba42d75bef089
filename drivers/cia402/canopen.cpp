#include "drivers/cia402/canopen.h"

#include <array>

namespace roomcal::drivers::cia402 {

namespace {

struct CodeName {
  uint16_t code, mask;
  const char* name;
};
// The narrowest mask first.
constexpr std::array<CodeName, 26> kNames{{
    {0x8110, 0xFFFF, "CAN messages lost"},
    {0x8120, 0xFFFF, "CAN error passive"},
    {0x8130, 0xFFFF, "it misses our heartbeat"},
    {0x8140, 0xFFFF, "it was bus-off"},
    {0x8210, 0xFFFF, "a PDO of a wrong length"},
    {0x8611, 0xFFFF, "following error"},
    {0x8612, 0xFFFF, "end of travel"},
    {0x7305, 0xFFFF, "encoder 1"},
    {0x7306, 0xFFFF, "encoder 2"},
    {0x8400, 0xFF00, "speed controller"},
    {0x8500, 0xFF00, "position controller"},
    {0x8600, 0xFF00, "positioning"},
    {0x7300, 0xFF00, "sensor"},
    {0x7100, 0xFF00, "power stage"},
    {0x6300, 0xFF00, "its parameters"},
    {0x8100, 0xFF00, "communication"},
    {0x8200, 0xFF00, "protocol"},
    {0x1000, 0xF000, "generic error"},
    {0x2000, 0xF000, "current"},
    {0x3000, 0xF000, "voltage"},
    {0x4000, 0xF000, "temperature"},
    {0x5000, 0xF000, "hardware"},
    {0x6000, 0xF000, "software"},
    {0x7000, 0xF000, "an added module"},
    {0x9000, 0xF000, "an external error"},
    {0xF000, 0xF000, "maker-specific"},
}};

ports::CanMessage message_of(uint32_t id, uint8_t length) {
  ports::CanMessage message;
  message.id = id;
  message.length = length;
  return message;
}

}  // namespace

uint32_t le(std::span<const uint8_t> bytes) {
  uint32_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) value |= uint32_t{bytes[i]} << (8 * i);
  return value;
}

void put_le(uint32_t value, std::span<uint8_t> bytes) {
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<uint8_t>(value >> (8 * i));
}

ports::CanMessage nmt_message(NmtCommand command, uint8_t node) {
  ports::CanMessage message = message_of(kNmtId, 2);
  message.data[0] = static_cast<uint8_t>(command);
  message.data[1] = node;
  return message;
}

ports::CanMessage sync_message() { return message_of(kSyncId, 0); }

ports::CanMessage heartbeat_message(uint8_t node, NmtState state) {
  ports::CanMessage message = message_of(heartbeat_id(node), 1);
  message.data[0] = static_cast<uint8_t>(state);
  return message;
}

bool read_heartbeat(const ports::CanMessage& message, NmtState& state) {
  if (message.length != 1) return false;
  state = static_cast<NmtState>(message.data[0] & 0x7F);  // bit 7 is node guarding's toggle
  return true;
}

bool read_emergency(const ports::CanMessage& message, Emergency& emergency) {
  if (message.length != 8) return false;
  emergency = {static_cast<uint16_t>(le(message.bytes().first(2))), message.data[2]};
  return true;
}

const char* emergency_name(uint16_t code) {
  for (const CodeName& row : kNames)
    if ((code & row.mask) == row.code) return row.name;
  return code == 0 ? "no error" : "unknown error";
}

}  // namespace roomcal::drivers::cia402
