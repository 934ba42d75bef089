#include "runtime/base/latest.h"

#include <thread>

#include <gtest/gtest.h>

namespace roomcal {
namespace {

struct Pair {
  uint64_t a = 0, b = 0;
};

TEST(Latest, BeforeAnythingWasSaid_IsDefault) {
  Latest<Pair> latest;
  EXPECT_EQ(latest.get().a, 0U);
}

TEST(Latest, SeveralValues_NewestIsRead) {
  Latest<int> latest;
  for (int i = 1; i <= 5; ++i) latest.set(i);
  EXPECT_EQ(latest.get(), 5);
  EXPECT_EQ(latest.get(), 5);
  latest.set(6);
  EXPECT_EQ(latest.get(), 6);
}

TEST(Latest, TwoThreads_ValuesAreWholeAndNeverOlderThanBefore) {
  constexpr uint64_t kValues = 200'000;
  Latest<Pair> latest;
  std::thread writer([&] {
    for (uint64_t i = 1; i <= kValues; ++i) latest.set({i, 3 * i});
  });
  uint64_t seen = 0;
  bool whole = true, ordered = true;
  while (seen < kValues) {
    const Pair now = latest.get();
    whole = whole && now.b == 3 * now.a;
    ordered = ordered && now.a >= seen;
    seen = now.a;
  }
  writer.join();
  EXPECT_TRUE(whole);
  EXPECT_TRUE(ordered);
}

}  // namespace
}  // namespace roomcal
