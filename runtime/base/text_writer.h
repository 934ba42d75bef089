#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace roomcal {

/// Appends text to a caller's buffer. What does not fit is not written and overflowed() tells, so a chain of calls is
/// checked once, at its end. Independent of the locale; no heap.
class TextWriter {
 public:
  explicit TextWriter(std::span<char> buffer) : buffer_(buffer) {}

  TextWriter& text(std::string_view text);
  TextWriter& character(char c) { return text({&c, 1}); }
  /// Finite doubles, as few digits as bring the same double back; always with a decimal point ("1.0", "0.0025",
  /// "1.5e-13"), so that YAML 1.1, JSON and XML readers all take it for a real. Not finite: "nan", "inf", "-inf".
  TextWriter& number(double value);
  /// With that many decimals, for people.
  TextWriter& fixed(double value, int decimals);
  TextWriter& integer(int64_t value);
  TextWriter& unsigned_integer(uint64_t value);
  /// Eight lower-case hexadecimal digits.
  TextWriter& hex(uint32_t value);
  /// In double quotes with JSON's escapes, which YAML shares. Bytes beyond printable ASCII become "?".
  TextWriter& quoted(std::string_view text);
  /// `text`, then spaces up to `width`.
  TextWriter& padded(std::string_view text, std::size_t width);

  std::string_view view() const { return {buffer_.data(), size_}; }
  bool overflowed() const { return overflowed_; }
  void clear() {
    size_ = 0;
    overflowed_ = false;
  }

 private:
  std::span<char> buffer_;
  std::size_t size_ = 0;
  bool overflowed_ = false;
};

}  // namespace roomcal
