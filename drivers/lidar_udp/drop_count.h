#pragma once

#include <cstdint>

namespace roomcal::drivers {

/// Makes one exact count of the kernel's two readings of a socket's drops: beside each packet (SO_RXQ_OVFL: as it stood
/// when the packet was queued, and only once it is not 0) and of the socket (SO_MEMINFO: as it stands now). Both show
/// the same 32-bit counter; the later value counts, whichever way it came.
class DropCount {
 public:
  void observe(uint32_t reading) {
    const auto ahead = static_cast<int32_t>(reading - last_);
    if (ahead <= 0) return;  // of a packet that was queued before the last reading
    total_ += static_cast<uint32_t>(ahead);
    last_ = reading;
  }
  uint64_t total() const { return total_; }

 private:
  uint32_t last_ = 0;
  uint64_t total_ = 0;
};

}  // namespace roomcal::drivers
