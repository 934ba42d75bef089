#include "drivers/cia402/sdo.h"

#include <array>

namespace roomcal::drivers::cia402 {

namespace {

constexpr uint8_t kReadRequest = 0x40, kWriteAnswer = 0x60, kAbort = 0x80;
constexpr uint32_t kAbortTimedOut = 0x05040000, kAbortUnknownCommand = 0x05040001;

// Command of an expedited write: specifier 1, 4 - bytes unused, expedited, size given.
constexpr uint8_t write_command(uint8_t bytes) { return static_cast<uint8_t>(0x23 | (4 - bytes) << 2); }
// Of an expedited answer to a read: how many bytes count; 0 if it is another one.
constexpr std::size_t bytes_of_answer(uint8_t command) {
  if ((command & 0xE2) != 0x42) return 0;
  return (command & 1) != 0 ? 4U - (command >> 2 & 3U) : 4U;
}

struct AbortName {
  uint32_t code;
  const char* name;
};
constexpr std::array<AbortName, 26> kNames{{
    {0x05030000, "toggle bit does not alternate"},
    {kAbortTimedOut, "it timed out"},
    {kAbortUnknownCommand, "unknown command"},
    {0x05040005, "it is out of memory"},
    {0x06010000, "access not supported"},
    {0x06010001, "cannot be read"},
    {0x06010002, "cannot be written"},
    {kAbortNoObject, "object does not exist"},
    {0x06040041, "object cannot be mapped"},
    {0x06040042, "mapping is too long"},
    {0x06040043, "incompatible parameter"},
    {0x06040047, "incompatible inside the device"},
    {0x06060000, "hardware error"},
    {0x06070010, "wrong type or length"},
    {0x06070012, "value is too long"},
    {0x06070013, "value is too short"},
    {kAbortNoSubIndex, "sub-index does not exist"},
    {0x06090030, "invalid value"},
    {0x06090031, "value is too high"},
    {0x06090032, "value is too low"},
    {0x08000000, "general error"},
    {0x08000020, "cannot be stored"},
    {0x08000021, "under local control"},
    {0x08000022, "not in its present state"},
    {0x08000023, "no object dictionary"},
    {kAbortNotExpedited, "its value is longer than four bytes"},
}};

}  // namespace

void SdoClient::begin(const ports::CanMessage& request, ObjectKey key, bool reads, int64_t now_ns) {
  request_ = request;
  request_.id = sdo_request_id(node_);
  request_.length = 8;
  put_le(key.index, std::span(request_.data).subspan(1, 2));
  request_.data[3] = key.sub;
  key_ = key;
  reads_ = reads;
  until_ns_ = now_ns + timeout_ns_;
  state_ = SdoState::kBusy;
  sent_ = bus_.send(request_).ok();
}

void SdoClient::download(ObjectKey key, uint32_t value, uint8_t bytes, int64_t now_ns) {
  ports::CanMessage message;
  message.data[0] = write_command(bytes);
  put_le(value, std::span(message.data).subspan(4, bytes));
  begin(message, key, false, now_ns);
}

void SdoClient::upload(ObjectKey key, int64_t now_ns) {
  ports::CanMessage message;
  message.data[0] = kReadRequest;
  begin(message, key, true, now_ns);
}

void SdoClient::send_abort(uint32_t code) {
  ports::CanMessage message;
  message.id = sdo_request_id(node_);
  message.length = 8;
  message.data[0] = kAbort;
  put_le(key_.index, std::span(message.data).subspan(1, 2));
  message.data[3] = key_.sub;
  put_le(code, std::span(message.data).subspan(4, 4));
  static_cast<void>(bus_.send(message));  // a courtesy: the transfer is over either way
}

void SdoClient::hear(const ports::CanMessage& message) {
  if (state_ != SdoState::kBusy || !sent_ || message.length != 8) return;
  const auto bytes = message.bytes();
  const ObjectKey key{static_cast<uint16_t>(le(bytes.subspan(1, 2))), bytes[3]};
  if (!(key == key_)) return;  // the late answer to something that timed out
  const uint8_t command = bytes[0];
  const std::size_t count = bytes_of_answer(command);
  if (command == kAbort) {
    abort_code_ = le(bytes.subspan(4, 4));
    state_ = SdoState::kAborted;
  } else if (!reads_ && command == kWriteAnswer) {
    state_ = SdoState::kDone;
  } else if (reads_ && count > 0) {
    value_ = le(bytes.subspan(4, count));
    state_ = SdoState::kDone;
  } else {
    abort_code_ = reads_ && (command & 0xE0) == 0x40 ? kAbortNotExpedited : kAbortUnknownCommand;
    send_abort(kAbortUnknownCommand);
    state_ = SdoState::kAborted;
  }
}

void SdoClient::poll(int64_t now_ns) {
  if (state_ != SdoState::kBusy) return;
  if (now_ns >= until_ns_) {
    if (sent_) send_abort(kAbortTimedOut);
    state_ = SdoState::kTimeout;
  } else if (!sent_) {
    sent_ = bus_.send(request_).ok();
  }
}

const char* abort_name(uint32_t code) {
  for (const AbortName& row : kNames)
    if (row.code == code) return row.name;
  return "unknown reason";
}

}  // namespace roomcal::drivers::cia402
