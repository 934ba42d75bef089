#include "tools/common/option_check.h"

#include <gtest/gtest.h>

namespace roomcal::tools {
namespace {

TEST(NumberBetween, OnlyFiniteNumbersInside_Pass) {
  const CLI::Validator check = number_between(0.5, 2.0, "m");
  for (const char* good : {"0.5", "1", "2", "2e0", "+1.5"}) {
    std::string text = good;
    EXPECT_EQ(check(text), "") << good;
  }
  for (const char* bad : {"nan", "NaN", "-nan", "inf", "0.49", "2.01", "-1", "1e999", "x", "1x", "", " "}) {
    std::string text = bad;
    EXPECT_NE(check(text).find("is not a number from 0.5 to 2 m"), std::string::npos) << bad;
  }
}

}  // namespace
}  // namespace roomcal::tools
