#pragma once

#include <cstddef>
#include <string_view>

namespace roomcal::profile {

/// Whether a text is an IPv4 address as inet_pton() takes it: four numbers up to 255 without leading zeros.
constexpr bool is_ipv4(std::string_view text) {
  for (int part = 0; part < 4; ++part) {
    if (part > 0) {
      if (text.empty() || text.front() != '.') return false;
      text.remove_prefix(1);
    }
    std::size_t digits = 0;
    int number = 0;
    while (digits < text.size() && digits < 4 && text[digits] >= '0' && text[digits] <= '9')
      number = 10 * number + (text[digits++] - '0');
    if (digits == 0 || number > 255 || (digits > 1 && text.front() == '0')) return false;
    text.remove_prefix(digits);
  }
  return text.empty();
}

}  // namespace roomcal::profile
