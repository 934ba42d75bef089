#pragma once

#include <cstdint>

namespace roomcal::drivers {

/// Paces attempts to get back what has gone: one a second, without end.
class Retry {
 public:
  static constexpr int64_t kPeriod_ns = 1'000'000'000;

  /// @param now_ns  monotonic. @return true if it is time for an attempt, which counts as made.
  bool due(int64_t now_ns) {
    if (now_ns < next_ns_) return false;
    next_ns_ = now_ns + kPeriod_ns;
    return true;
  }

 private:
  int64_t next_ns_ = INT64_MIN;
};

}  // namespace roomcal::drivers
