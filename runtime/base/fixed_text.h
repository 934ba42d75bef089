#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace roomcal {

/// A short text in place: names and one-line reasons. Longer input is cut at the capacity, which keeps a reason
/// readable; it is never an error, because a reason must not fail.
template <std::size_t kCapacity>
class FixedText {
 public:
  FixedText() = default;
  FixedText(std::string_view text) { append(text); }  // NOLINT: implicit by design
  FixedText(const char* text) { append(text); }       // NOLINT: implicit by design

  void append(std::string_view text) {
    for (const char c : text) {
      if (size_ == kCapacity) return;
      chars_[size_++] = c;
    }
  }
  void clear() { size_ = 0; }
  std::string_view view() const { return {chars_.data(), size_}; }
  bool empty() const { return size_ == 0; }
  static constexpr std::size_t capacity() { return kCapacity; }

 private:
  std::array<char, kCapacity> chars_{};
  std::size_t size_ = 0;
};

using SensorName = FixedText<31>;
using Reason = FixedText<200>;

}  // namespace roomcal
