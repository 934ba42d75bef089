#include "runtime/base/text_writer.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

#include <gtest/gtest.h>

namespace roomcal {
namespace {

template <typename Write>
std::string written(const Write& write) {
  std::array<char, 512> buffer{};
  TextWriter out(buffer);
  write(out);
  return std::string(out.view());
}

TEST(TextWriter, Numbers_ComeBackBitByBitAndLookReal) {
  for (const double value : {0.0, 1.0, -1.0, 0.1, 1.0 / 3, 1e-12, 9.9e-13, 1e15, 123456789.125, -2.5e-300, 1.7e308,
                             std::numeric_limits<double>::denorm_min(), std::nextafter(1.0, 2.0)}) {
    const std::string text = written([&](TextWriter& out) { out.number(value); });
    EXPECT_EQ(std::strtod(text.c_str(), nullptr), value) << text;
    EXPECT_NE(text.find('.'), std::string::npos) << text;
  }
  EXPECT_EQ(written([](TextWriter& out) { out.number(1e-13); }), "1.0e-13");
  EXPECT_EQ(written([](TextWriter& out) { out.number(0.0025); }), "0.0025");
  EXPECT_EQ(written([](TextWriter& out) { out.number(-0.0); }), "-0.0");
}

TEST(TextWriter, NotFinite_IsNamed) {
  EXPECT_EQ(written([](TextWriter& out) { out.number(std::nan("")).text(" ").number(-HUGE_VAL); }), "nan -inf");
  EXPECT_EQ(written([](TextWriter& out) { out.fixed(HUGE_VAL, 2); }), "inf");
}

TEST(TextWriter, WholeNumbersHexAndPadding) {
  EXPECT_EQ(written([](TextWriter& out) { out.integer(INT64_MIN).text(" ").unsigned_integer(UINT64_MAX); }),
            "-9223372036854775808 18446744073709551615");
  EXPECT_EQ(written([](TextWriter& out) { out.hex(0x00C0FFEE); }), "00c0ffee");
  EXPECT_EQ(written([](TextWriter& out) { out.padded("ab", 4).padded("abcde", 4).text("|"); }), "ab  abcde|");
  EXPECT_EQ(written([](TextWriter& out) { out.fixed(2.0 / 3, 3); }), "0.667");
}

TEST(TextWriter, Quoted_EscapesWhatJsonEscapes) {
  EXPECT_EQ(written([](TextWriter& out) { out.quoted("a\"b\\c\nd\te\x01\xff"); }), "\"a\\\"b\\\\c\\nd\\te??\"");
}

TEST(TextWriter, FullBuffer_StopsAtAWholePieceAndTells) {
  std::array<char, 5> buffer{};
  TextWriter out(buffer);
  out.text("abc").text("def");
  EXPECT_EQ(out.view(), "abc");
  EXPECT_TRUE(out.overflowed());
  out.text("g");
  EXPECT_EQ(out.view(), "abc");
  out.clear();
  EXPECT_TRUE(out.text("12345").view() == "12345" && !out.overflowed());
}

}  // namespace
}  // namespace roomcal
