#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "runtime/base/fixed_text.h"

namespace roomcal::drivers {

/// A fixed text as system calls want it: with a zero behind it.
template <std::size_t kCapacity>
class CText {
 public:
  explicit CText(const FixedText<kCapacity>& text) {
    std::copy(text.view().begin(), text.view().end(), chars_.begin());
  }
  const char* c_str() const { return chars_.data(); }

 private:
  std::array<char, kCapacity + 1> chars_{};
};

}  // namespace roomcal::drivers
