#include "runtime/base/text_writer.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace roomcal {

namespace {

// Outside of this range positional digits become long; inside, at most 13 zeros and 17 digits.
constexpr double kSmallest = 1e-12;
constexpr double kLargest = 1e15;

using Digits = std::array<char, 512>;  // the longest double in positional notation takes 325 characters

template <typename... Arguments>
std::string_view to_digits(Digits& digits, Arguments... arguments) {
  const std::to_chars_result end = std::to_chars(digits.data(), digits.data() + digits.size(), arguments...);
  return {digits.data(), static_cast<std::size_t>(end.ptr - digits.data())};
}

}  // namespace

TextWriter& TextWriter::text(std::string_view text) {
  if (overflowed_ || text.size() > buffer_.size() - size_) {
    overflowed_ = true;
    return *this;
  }
  std::copy(text.begin(), text.end(), buffer_.begin() + static_cast<std::ptrdiff_t>(size_));
  size_ += text.size();
  return *this;
}

TextWriter& TextWriter::number(double value) {
  if (std::isnan(value)) return text("nan");
  if (std::isinf(value)) return text(value > 0 ? "inf" : "-inf");
  Digits digits;
  const double size = std::abs(value);
  if (size == 0 || (size >= kSmallest && size < kLargest)) {
    const std::string_view plain = to_digits(digits, value, std::chars_format::fixed);
    text(plain);
    return plain.find('.') == std::string_view::npos ? text(".0") : *this;
  }
  const std::string_view plain = to_digits(digits, value, std::chars_format::scientific);
  const std::size_t exponent = plain.find('e');
  text(plain.substr(0, exponent));
  if (plain.substr(0, exponent).find('.') == std::string_view::npos) text(".0");
  return text(plain.substr(exponent));
}

TextWriter& TextWriter::fixed(double value, int decimals) {
  if (!std::isfinite(value) || std::abs(value) >= kLargest) return number(value);
  Digits digits;
  return text(to_digits(digits, value, std::chars_format::fixed, decimals));
}

TextWriter& TextWriter::integer(int64_t value) {
  Digits digits;
  return text(to_digits(digits, value));
}

TextWriter& TextWriter::unsigned_integer(uint64_t value) {
  Digits digits;
  return text(to_digits(digits, value));
}

TextWriter& TextWriter::hex(uint32_t value) {
  std::array<char, 8> digits{};
  for (std::size_t i = 0; i < digits.size(); ++i) digits[i] = "0123456789abcdef"[value >> (28 - 4 * i) & 0xFU];
  return text({digits.data(), digits.size()});
}

TextWriter& TextWriter::quoted(std::string_view words) {
  character('"');
  for (const char c : words) {
    if (c == '"' || c == '\\')
      character('\\').character(c);
    else if (c == '\n')
      text("\\n");
    else if (c == '\t')
      text("\\t");
    else
      character(c >= ' ' && c <= '~' ? c : '?');
  }
  return character('"');
}

TextWriter& TextWriter::padded(std::string_view words, std::size_t width) {
  text(words);
  for (std::size_t i = words.size(); i < width; ++i) character(' ');
  return *this;
}

}  // namespace roomcal
