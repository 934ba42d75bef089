#pragma once

#include <cstdint>

#include "drivers/cia402/canopen.h"
#include "runtime/ports/can_bus.h"

namespace roomcal::drivers::cia402 {

/// An entry of a node's object dictionary.
struct ObjectKey {
  uint16_t index = 0;
  uint8_t sub = 0;

  friend bool operator==(const ObjectKey&, const ObjectKey&) = default;
};

enum class SdoState : uint8_t {
  kIdle,
  kBusy,
  kDone,
  kAborted,  ///< by the node; abort_code() says why
  kTimeout,  ///< no answer, or the bus did not take the request
};

/// Expedited transfers of one to four bytes with one node, one at a time. Source: CiA 301, 7.2.4.3.
class SdoClient {
 public:
  /// @param bus  outlives the client.
  SdoClient(ports::CanBus& bus, uint8_t node, int64_t timeout_ns) : bus_(bus), node_(node), timeout_ns_(timeout_ns) {}

  /// Begins to write. @param bytes  1 to 4. A transfer that runs is forgotten.
  void download(ObjectKey key, uint32_t value, uint8_t bytes, int64_t now_ns);
  /// Begins to read.
  void upload(ObjectKey key, int64_t now_ns);
  /// An answer of the node; answers to something else are ignored.
  void hear(const ports::CanMessage& message);
  void poll(int64_t now_ns);
  void reset() { state_ = SdoState::kIdle; }

  SdoState state() const { return state_; }
  ObjectKey key() const { return key_; }
  uint32_t value() const { return value_; }  ///< that was read, zero beyond its bytes
  uint32_t abort_code() const { return abort_code_; }

 private:
  void begin(const ports::CanMessage& request, ObjectKey key, bool reads, int64_t now_ns);
  void send_abort(uint32_t code);

  ports::CanBus& bus_;
  uint8_t node_;
  int64_t timeout_ns_;
  SdoState state_ = SdoState::kIdle;
  ObjectKey key_;
  bool reads_ = false, sent_ = false;
  ports::CanMessage request_;
  int64_t until_ns_ = 0;
  uint32_t value_ = 0, abort_code_ = 0;
};

/// Abort codes that the servo's set-up tells apart.
inline constexpr uint32_t kAbortNoObject = 0x06020000, kAbortNoSubIndex = 0x06090011;
/// Not a code of the standard: the node answered with a longer transfer than it may.
inline constexpr uint32_t kAbortNotExpedited = 0xFFFFFFFF;
/// "object does not exist", ... Never null. Source: CiA 301, table 22.
const char* abort_name(uint32_t code);

}  // namespace roomcal::drivers::cia402
