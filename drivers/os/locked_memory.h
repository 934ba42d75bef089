#pragma once

#include <cstddef>
#include <span>

#include "runtime/base/status.h"

namespace roomcal::drivers {

/// One block of memory that is there before it is needed: mapped, touched, and locked against being swapped out.
/// Page-aligned, zero. Given back on destruction.
class LockedMemory {
 public:
  LockedMemory() = default;
  ~LockedMemory() { release(); }
  LockedMemory(LockedMemory&& other) noexcept;
  LockedMemory& operator=(LockedMemory&& other) noexcept;

  /// @param bytes  rounded up to whole pages.
  /// @return kInvalidArgument for 0 bytes; kOutOfMemory if the system has no such block. What was held before is given
  ///         back in any case.
  Status reserve(std::size_t bytes);

  std::span<std::byte> bytes() const { return bytes_; }

  /// Whether the block is locked. @return kUnavailable, with the limit to raise, if the system did not let us: the
  /// block then works, but a machine that swaps may delay its use.
  Status lock_status() const { return lock_status_; }

 private:
  void release();

  std::span<std::byte> bytes_;
  Status lock_status_;
};

}  // namespace roomcal::drivers
