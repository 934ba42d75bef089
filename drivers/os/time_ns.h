#pragma once

#include <cstdint>
#include <ctime>

namespace roomcal::drivers {

/// Nanoseconds of a kernel's time in two parts. Both are 64 bits wide before they are multiplied: time_t has 32 on
/// armhf.
constexpr int64_t to_ns(int64_t seconds, int64_t nanoseconds) { return seconds * 1'000'000'000 + nanoseconds; }

inline int64_t to_ns(const timespec& time) {
  return to_ns(static_cast<int64_t>(time.tv_sec), static_cast<int64_t>(time.tv_nsec));
}

/// @param ns  not negative.
inline timespec to_timespec(int64_t ns) {
  timespec time{};
  time.tv_sec = static_cast<decltype(time.tv_sec)>(ns / 1'000'000'000);
  time.tv_nsec = static_cast<decltype(time.tv_nsec)>(ns % 1'000'000'000);
  return time;
}

}  // namespace roomcal::drivers
