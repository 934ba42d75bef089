#pragma once

#include <cstddef>
#include <span>

namespace roomcal::ports {

/// Where console output goes: a serial line, a pty, a socket.
class ByteSink {
 public:
  virtual ~ByteSink() = default;
  /// Takes as many bytes from the front as it can without waiting. @return how many; 0 when there is no room now.
  virtual std::size_t write_some(std::span<const char> bytes) = 0;
};

}  // namespace roomcal::ports
