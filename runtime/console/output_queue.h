#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "runtime/ports/byte_sink.h"

namespace roomcal::console {

/// Ring of bytes on their way out. A message enters whole or not at all; what did not fit is counted. Nobody ever
/// waits.
class OutputQueue {
 public:
  OutputQueue() = default;
  explicit OutputQueue(std::span<char> ring) : ring_(ring) {}

  /// @param newline  what a "\n" becomes: a terminal wants "\r\n".
  /// @return false if there was no room; the message is then lost and counted.
  bool push(std::string_view message, std::string_view newline);
  /// Hands the sink what it takes now.
  void pump(ports::ByteSink& sink);

  std::size_t size() const { return size_; }
  std::size_t capacity() const { return ring_.size(); }
  uint64_t lost_messages() const { return lost_messages_; }
  uint64_t lost_bytes() const { return lost_bytes_; }

 private:
  void put(std::string_view text);

  std::span<char> ring_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
  uint64_t lost_messages_ = 0;
  uint64_t lost_bytes_ = 0;
};

}  // namespace roomcal::console
