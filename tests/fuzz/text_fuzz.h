#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "tools/common/error.h"

namespace roomcal::tools::test {

/// Hands the bytes to a text parser. A ToolError is its answer to bad text; anything else that it throws is a finding,
/// and so is a refusal that does not name the file.
template <typename Parse>
int fuzz_text(const uint8_t* data, std::size_t size, const Parse& parse) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    parse(text);
  } catch (const ToolError& error) {
    if (!std::string(error.what()).starts_with("input")) __builtin_trap();
  }
  return 0;
}

}  // namespace roomcal::tools::test
