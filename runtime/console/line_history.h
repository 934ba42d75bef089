#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "runtime/base/fixed_text.h"

namespace roomcal::console {

inline constexpr std::size_t kMaxLine = 120;

/// The last lines that were entered, oldest overwritten first.
class LineHistory {
 public:
  static constexpr std::size_t kLines = 16;

  /// Empty lines and repetitions of the last one are not kept.
  void add(std::string_view line) {
    if (line.empty() || (count_ > 0 && at(0) == line)) return;
    lines_[next_ % kLines] = FixedText<kMaxLine>(line);
    ++next_;
    if (count_ < kLines) ++count_;
  }
  std::size_t count() const { return count_; }
  /// @param back  0 for the last line, count() - 1 for the oldest.
  std::string_view at(std::size_t back) const { return lines_[(next_ - 1 - back) % kLines].view(); }

 private:
  std::array<FixedText<kMaxLine>, kLines> lines_;
  std::size_t next_ = 0;
  std::size_t count_ = 0;
};

}  // namespace roomcal::console
