#pragma once

#include <algorithm>
#include <string_view>

namespace roomcal {

/// Whether a sensor may be called so: letters, digits, `_`, `-`, `.`, at least one. Names go into file names, YAML
/// keys, XML attributes and the console as they are.
constexpr bool is_name(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
           c == '.';
  });
}

/// Whether a text may be shown as it is: printable ASCII, spaces among it; also if it is empty.
constexpr bool is_printable(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

}  // namespace roomcal
