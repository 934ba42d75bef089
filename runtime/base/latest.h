#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace roomcal {

/// The newest value that one thread has said, for one other thread. Neither ever waits for the other.
///
/// Three copies: one that is being written, one that is being read, and one that changes hands.
template <typename T>
class Latest {
 public:
  Latest() = default;
  Latest(const Latest&) = delete;
  Latest& operator=(const Latest&) = delete;

  /// By the one writer.
  void set(const T& value) {
    copies_[writing_] = value;
    writing_ = between_.exchange(static_cast<uint8_t>(writing_ | kFresh), std::memory_order_acq_rel) & kIndex;
  }
  /// By the one reader; a default-constructed T before the first set().
  const T& get() {
    if ((between_.load(std::memory_order_relaxed) & kFresh) != 0)
      reading_ = between_.exchange(reading_, std::memory_order_acq_rel) & kIndex;
    return copies_[reading_];
  }

 private:
  static constexpr uint8_t kIndex = 3, kFresh = 4;

  std::array<T, 3> copies_{};
  std::atomic<uint8_t> between_{1};
  uint8_t writing_ = 0;
  uint8_t reading_ = 2;
};

}  // namespace roomcal
