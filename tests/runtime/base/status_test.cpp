#include "runtime/base/status.h"

#include <gtest/gtest.h>

#include "runtime/base/time.h"

namespace roomcal {
namespace {

Status fail_when(bool fail) { return fail ? Status(StatusCode::kCorrupt, "why") : ok_status(); }

Status try_it(bool fail, bool& reached_end) {
  ROOMCAL_TRY(fail_when(fail));
  reached_end = true;
  return ok_status();
}

TEST(Status, Try_ReturnsTheFirstFailure) {
  bool reached_end = false;
  EXPECT_EQ(try_it(true, reached_end).code(), StatusCode::kCorrupt);
  EXPECT_FALSE(reached_end);
  EXPECT_TRUE(try_it(false, reached_end).ok());
  EXPECT_TRUE(reached_end);
}

TEST(Result, Failure_CarriesItsStatus) {
  const Result<int> bad = Status(StatusCode::kNotFound, "gone");
  EXPECT_FALSE(bad.ok());
  EXPECT_STREQ(bad.status().detail(), "gone");
  EXPECT_EQ(Result<int>(3).value(), 3);
}

TEST(Stamp, OfDifferentOrUnknownClocks_DoNotCompare) {
  EXPECT_FALSE(comparable({1, ClockId::kMonotonic}, {1, ClockId::kTai}));
  EXPECT_FALSE(comparable({1, ClockId::kUnknown}, {1, ClockId::kUnknown}));
  EXPECT_TRUE(comparable({1, ClockId::kTai}, {2, ClockId::kTai}));
}

}  // namespace
}  // namespace roomcal
