#include "runtime/base/names.h"

#include <string>

#include <gtest/gtest.h>

namespace roomcal {
namespace {

TEST(IsName, EveryByte_OnlyLettersDigitsAndThreeMarks) {
  for (int c = 0; c < 256; ++c) {
    const char text[] = {'a', static_cast<char>(c)};
    const bool wanted =
        (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_' || c == '-' || c == '.';
    EXPECT_EQ(is_name({text, 2}), wanted) << c;
  }
}

TEST(IsName, Empty_IsNone) { EXPECT_FALSE(is_name("")); }

TEST(IsPrintable, EveryByte_OnlyAsciiThatIsSeen) {
  for (int c = 0; c < 256; ++c) {
    const char text[] = {'a', static_cast<char>(c)};
    EXPECT_EQ(is_printable({text, 2}), c >= 0x20 && c < 0x7F) << c;
  }
  EXPECT_TRUE(is_printable(""));
}

}  // namespace
}  // namespace roomcal
