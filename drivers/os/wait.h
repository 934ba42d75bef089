#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace roomcal::drivers {

inline constexpr std::size_t kMaxWaitFds = 32;

/// Waits until a descriptor can be read, at most until `deadline_ns` (monotonic; a past one only looks).
/// A descriptor that has an error or hung up counts as readable: whoever reads it finds out.
/// @param fds  up to kMaxWaitFds; negative ones (closed) are passed over.
/// @return bit i set for fds[i]; 0 when the time is over or a signal came. No heap.
uint32_t wait_readable(std::span<const int> fds, int64_t deadline_ns);

}  // namespace roomcal::drivers
