#include "runtime/press/state.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

namespace roomcal::press {
namespace {

/// Names of all values up to the last one.
template <typename Enum>
std::set<std::string> names(Enum last) {
  std::set<std::string> all;
  for (int i = 0; i <= static_cast<int>(last); ++i) all.insert(to_string(static_cast<Enum>(i)));
  return all;
}

TEST(StateNames, EveryValue_HasItsOwn) {
  EXPECT_EQ(names(State::kCheck).size(), 10U);
  EXPECT_EQ(names(Kind::kDryRun).size(), 3U);
  EXPECT_EQ(names(Result::kAborted).size(), 6U);
  EXPECT_EQ(names(Trouble::kDevice).size(), 8U);
}

TEST(StateNames, ValuesThatAreNone_AreTold) {
  EXPECT_STREQ(to_string(static_cast<State>(99)), "UNKNOWN");
  EXPECT_STREQ(to_string(static_cast<Kind>(99)), "unknown");
  EXPECT_STREQ(to_string(static_cast<Result>(99)), "UNKNOWN");
  EXPECT_STREQ(to_string(static_cast<Trouble>(99)), "unknown");
}

TEST(Result, OfAVerdict_IsItsNamesake) {
  for (const Verdict verdict : {Verdict::kPass, Verdict::kPassAdvise, Verdict::kFailRetry, Verdict::kFailService})
    EXPECT_STREQ(to_string(to_result(verdict)), to_string(verdict));
}

}  // namespace
}  // namespace roomcal::press
