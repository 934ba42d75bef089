#include "drivers/gige/gvcp.h"

#include <cassert>

namespace roomcal::drivers::gvcp {

namespace {

constexpr uint8_t kCommandMark = 0x42;
constexpr uint8_t kAcknowledgeFlag = 0x01;
constexpr uint8_t kScheduledFlag = 0x80;
constexpr uint16_t kActionCommand = 0x0100;
constexpr uint16_t kReadRegisterCommand = 0x0080;
constexpr std::size_t kHeader = 8;
constexpr uint16_t kActionBytes = 12;
constexpr uint16_t kTimeBytes = 8;
constexpr uint16_t kRegisterBytes = 4;

template <typename T>
void append(Datagram& datagram, T value) {
  for (int shift = static_cast<int>(sizeof(T)) * 8 - 8; shift >= 0; shift -= 8) {
    const bool fits = datagram.push_back(static_cast<std::byte>(value >> shift));
    assert(fits);
    static_cast<void>(fits);
  }
}

template <typename T>
T read(std::span<const std::byte> bytes, std::size_t at) {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) value = static_cast<T>(value << 8 | std::to_integer<T>(bytes[at + i]));
  return value;
}

Datagram header(uint8_t flags, uint16_t command, uint16_t length, uint16_t id) {
  Datagram datagram;
  append(datagram, kCommandMark);
  append(datagram, flags);
  append(datagram, command);
  append(datagram, length);
  append(datagram, id);
  return datagram;
}

}  // namespace

Datagram action_command(const ActionCommand& command) {
  const bool scheduled = command.action_time.has_value();
  const auto flags =
      static_cast<uint8_t>((command.acknowledge ? kAcknowledgeFlag : 0) | (scheduled ? kScheduledFlag : 0));
  const auto length = static_cast<uint16_t>(kActionBytes + (scheduled ? kTimeBytes : 0));
  Datagram datagram = header(flags, kActionCommand, length, command.id);
  append(datagram, command.device_key);
  append(datagram, command.group_key);
  append(datagram, command.group_mask);
  if (scheduled) append(datagram, *command.action_time);
  return datagram;
}

Datagram read_register(uint16_t id, uint32_t address) {
  Datagram datagram = header(kAcknowledgeFlag, kReadRegisterCommand, kRegisterBytes, id);
  append(datagram, address);
  return datagram;
}

std::optional<Acknowledgement> parse_acknowledgement(std::span<const std::byte> datagram, Answer answer) {
  if (datagram.size() < kHeader) return std::nullopt;
  if (read<uint16_t>(datagram, 2) != static_cast<uint16_t>(answer)) return std::nullopt;
  const std::size_t length = read<uint16_t>(datagram, 4);
  if (datagram.size() < kHeader + length) return std::nullopt;
  Acknowledgement ack{read<uint16_t>(datagram, 0), read<uint16_t>(datagram, 6), 0};
  if (answer != Answer::kReadRegister || ack.status != kSuccess) return ack;
  if (length < kRegisterBytes) return std::nullopt;
  ack.value = read<uint32_t>(datagram, kHeader);
  return ack;
}

}  // namespace roomcal::drivers::gvcp
