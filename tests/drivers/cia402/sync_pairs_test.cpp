// The state table of sync_pairs.h, row by row.
#include "drivers/cia402/sync_pairs.h"

#include <gtest/gtest.h>

namespace roomcal::drivers::cia402 {
namespace {

constexpr int64_t kMs = 1'000'000;

Stamp at(int64_t ms, ClockId clock = ClockId::kRealtime) { return {ms * kMs, clock}; }

struct SyncPairsTest : testing::Test {
  SyncPairsTest() { pairs.restart(0); }
  void send(int64_t ms) {
    ASSERT_TRUE(pairs.due(ms * kMs));
    pairs.sent(true);
  }

  SyncPairs pairs{10 * kMs};
  Stamp stamp;
};

TEST_F(SyncPairsTest, Answer_GetsTheStampOfItsSync) {
  send(0);
  EXPECT_FALSE(pairs.pair(at(1000), stamp)) << "not on the bus yet";
  pairs.confirmed(at(1003), 1 * kMs);
  ASSERT_TRUE(pairs.pair(at(1004), stamp));
  EXPECT_EQ(stamp, at(1003));
  EXPECT_FALSE(pairs.pair(at(1005), stamp)) << "one answer a SYNC";
  EXPECT_EQ(pairs.counters().unasked, 2U);
}

TEST_F(SyncPairsTest, AnswerOutsideOfItsWindow_IsNobodys) {
  send(0);
  pairs.confirmed(at(1003), 0);
  EXPECT_FALSE(pairs.pair(at(1002), stamp)) << "before the SYNC";
  EXPECT_FALSE(pairs.pair(at(1009), stamp)) << "later than half a period";
  EXPECT_FALSE(pairs.pair(at(1004, ClockId::kUnknown), stamp));
  EXPECT_FALSE(pairs.pair(at(1004, ClockId::kMonotonic), stamp));
  EXPECT_TRUE(pairs.pair(at(1008), stamp));
}

TEST_F(SyncPairsTest, PeriodsThatWereMissed_AreNotMadeUpFor) {
  send(0);
  pairs.confirmed(at(0), 0);
  EXPECT_FALSE(pairs.due(9 * kMs));
  EXPECT_TRUE(pairs.due(12 * kMs));
  EXPECT_FALSE(pairs.due(19 * kMs));
  EXPECT_TRUE(pairs.due(20 * kMs)) << "in step, though the one before was late";
  EXPECT_TRUE(pairs.due(95 * kMs));
  EXPECT_FALSE(pairs.due(104 * kMs));
  EXPECT_TRUE(pairs.due(105 * kMs));
}

TEST_F(SyncPairsTest, UnconfirmedSync_KeepsTheNextOneBack) {
  send(0);
  EXPECT_FALSE(pairs.due(10 * kMs));
  EXPECT_FALSE(pairs.due(20 * kMs));
  EXPECT_EQ(pairs.counters().skipped, 2U);
  EXPECT_EQ(pairs.silent_ns(25 * kMs), 25 * kMs);
  pairs.confirmed(at(1000), 26 * kMs);
  EXPECT_EQ(pairs.silent_ns(27 * kMs), 1 * kMs);
  EXPECT_TRUE(pairs.due(30 * kMs));
}

TEST_F(SyncPairsTest, UnansweredOnes_AreCountedInARow) {
  for (int64_t i = 0; i < 5; ++i) {
    send(10 * i);
    pairs.confirmed(at(10 * i), 10 * i * kMs);
  }
  EXPECT_EQ(pairs.unanswered_in_a_row(), 4U);
  EXPECT_TRUE(pairs.pair(at(41), stamp));
  EXPECT_EQ(pairs.unanswered_in_a_row(), 0U);
  EXPECT_EQ(pairs.counters().unanswered, 4U);
}

TEST_F(SyncPairsTest, RefusedSync_IsTriedWithTheNextPeriod) {
  ASSERT_TRUE(pairs.due(0));
  pairs.sent(false);
  pairs.confirmed(at(1), 1);
  EXPECT_FALSE(pairs.pair(at(2), stamp)) << "a confirmation of nothing";
  EXPECT_TRUE(pairs.due(10 * kMs));
  EXPECT_EQ(pairs.counters().refused, 1U);
}

TEST_F(SyncPairsTest, SyncOfSomebodyElse_TakesTheAnswerAway) {
  send(0);
  pairs.confirmed(at(0), 0);
  pairs.disturbed();
  EXPECT_FALSE(pairs.pair(at(1), stamp));
  EXPECT_EQ(pairs.unanswered_in_a_row(), 1U);
}

}  // namespace
}  // namespace roomcal::drivers::cia402
