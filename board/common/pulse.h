#pragma once

#include <atomic>
#include <cstdint>

namespace roomcal::board {

/// A thread's sign of life: it beats, the supervisor looks. The watchdog is fed only while all of them are fresh.
class Pulse {
 public:
  void beat(int64_t now_ns) { last_ns_.store(now_ns, std::memory_order_relaxed); }
  std::atomic<int64_t>& last() { return last_ns_; }
  int64_t last_ns() const { return last_ns_.load(std::memory_order_relaxed); }

 private:
  std::atomic<int64_t> last_ns_{0};
};

}  // namespace roomcal::board
