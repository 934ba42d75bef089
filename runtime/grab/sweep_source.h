#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/lidar/sweep.h"

namespace roomcal::grab {

/// Whole sweeps of one LiDAR, on demand. The session's thread calls all of it; packets come from another one.
class SweepSource {
 public:
  virtual ~SweepSource() = default;

  /// Begins to keep sweeps that begin after this call, the next `count` whole ones. Not before stop() has returned
  /// true.
  virtual void ask(std::size_t count) = 0;
  /// All that were asked for are there.
  virtual bool full() const = 0;
  /// Ends keeping. @return false while the receiving thread is in the middle of a packet: call again a little later.
  virtual bool stop() = 0;
  /// What was kept, once stop() returned true; valid until the next ask().
  virtual std::span<const lidar::Sweep> sweeps() const = 0;
  /// Sweeps that came since ask() and were not whole, and what was wrong with any of them (bits of SweepFlag).
  virtual uint32_t discarded() const = 0;
  virtual uint32_t discarded_flags() const = 0;
};

}  // namespace roomcal::grab
