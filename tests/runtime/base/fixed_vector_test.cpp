#include "runtime/base/fixed_vector.h"

#include <gtest/gtest.h>

#include "runtime/base/fixed_text.h"

namespace roomcal {
namespace {

TEST(FixedVector, Full_RefusesAndKeepsItsContent) {
  FixedVector<int, 2> v;
  EXPECT_TRUE(v.push_back(1));
  EXPECT_TRUE(v.push_back(2));
  EXPECT_FALSE(v.push_back(3));
  ASSERT_EQ(v.size(), 2u);
  EXPECT_EQ(v.back(), 2);
}

TEST(FixedText, LongerThanItsCapacity_IsCut) {
  FixedText<4> text("abc");
  text.append("def");
  EXPECT_EQ(text.view(), "abcd");
}

}  // namespace
}  // namespace roomcal
