#pragma once

#include <string>

#include "tools/common/error.h"

namespace roomcal::tools::test {

/// The message that `work` refuses with, or "" if it does not. Anything but a ToolError passes on and fails the test.
template <typename Work>
std::string refusal(const Work& work) {
  try {
    work();
  } catch (const ToolError& error) {
    return error.what();
  }
  return "";
}

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace roomcal::tools::test
