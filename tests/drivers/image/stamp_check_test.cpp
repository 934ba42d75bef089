#include "drivers/image/stamp_check.h"

#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace roomcal::drivers {
namespace {

using ports::ImageFault;

constexpr int64_t kMs = 1'000'000, kS = 1'000'000'000;

Stamp mono(int64_t ns) { return {ns, ClockId::kMonotonic}; }
Stamp utc(int64_t ns) { return {ns, ClockId::kRealtime}; }

TEST(StampCheck, StampsJustBeforeNow_AreBelieved) {
  StampCheck check;
  for (int64_t i = 1; i < 100; ++i)
    EXPECT_EQ(check.judge(mono(i * 33 * kMs), mono(i * 33 * kMs + 40 * kMs)), ImageFault::kCount);
}

TEST(StampCheck, EveryDoubt_HasItsName) {
  const int64_t now = 1'700'000'000 * kS;
  struct {
    int64_t ahead_ns;
    ImageFault expected;
  } const cases[] = {
      {-900 * kMs, ImageFault::kCount},
      {-1001 * kMs, ImageFault::kStampOld},
      {0, ImageFault::kCount},
      {1 * kMs, ImageFault::kCount},
      {2 * kMs, ImageFault::kStampFuture},
      {36'499 * kMs, ImageFault::kStampFuture},
      {36'500 * kMs, ImageFault::kStampTai},
      {37 * kS - 20 * kMs, ImageFault::kStampTai},
      {37'500 * kMs, ImageFault::kStampTai},
      {37'501 * kMs, ImageFault::kStampFuture},
      {-37 * kS, ImageFault::kStampOld},
  };
  for (const auto& c : cases) {
    StampCheck check;
    EXPECT_EQ(check.judge(utc(now + c.ahead_ns), utc(now)), c.expected) << c.ahead_ns;
  }
}

TEST(StampCheck, FrozenAndBackwards_AreToldFromTheStampBefore) {
  StampCheck check;
  EXPECT_EQ(check.judge(mono(5 * kS), mono(5 * kS)), ImageFault::kCount);
  EXPECT_EQ(check.judge(mono(5 * kS), mono(5 * kS + 30 * kMs)), ImageFault::kStampFrozen);
  EXPECT_EQ(check.judge(mono(5 * kS), mono(5 * kS + 60 * kMs)), ImageFault::kStampFrozen);
  EXPECT_EQ(check.judge(mono(5 * kS - 1), mono(5 * kS + 90 * kMs)), ImageFault::kStampBackwards);
  EXPECT_EQ(check.judge(mono(5 * kS + 1), mono(5 * kS + 90 * kMs)), ImageFault::kCount);
  check.restart();
  EXPECT_EQ(check.judge(mono(5 * kS - 5), mono(5 * kS + 99 * kMs)), ImageFault::kCount);
}

TEST(StampCheck, OneStampFromTheFuture_CostsItselfAndItsSuccessorOnly) {
  StampCheck check;
  EXPECT_EQ(check.judge(mono(1 * kS), mono(1 * kS)), ImageFault::kCount);
  EXPECT_EQ(check.judge(mono(90 * kS), mono(1 * kS + 33 * kMs)), ImageFault::kStampFuture);
  EXPECT_EQ(check.judge(mono(1 * kS + 66 * kMs), mono(1 * kS + 66 * kMs)), ImageFault::kStampBackwards);
  EXPECT_EQ(check.judge(mono(1 * kS + 99 * kMs), mono(1 * kS + 99 * kMs)), ImageFault::kCount);
}

TEST(StampCheck, ClockUnknown_IsSaidEachTime) {
  StampCheck check;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(check.judge({i, ClockId::kUnknown}, mono(i)), ImageFault::kStampUnknown);
}

TEST(StampCheck, ClockOfTheCamera_OnlyItsOrderCounts) {
  StampCheck check;
  EXPECT_EQ(check.judge({900 * kS, ClockId::kDevice}, mono(kS)), ImageFault::kCount);
  EXPECT_EQ(check.judge({901 * kS, ClockId::kDevice}, mono(2 * kS)), ImageFault::kCount);
  EXPECT_EQ(check.judge({901 * kS, ClockId::kDevice}, mono(3 * kS)), ImageFault::kStampFrozen);
  EXPECT_EQ(check.judge({900 * kS, ClockId::kDevice}, mono(3 * kS)), ImageFault::kStampBackwards);
}

TEST(StampCheck, NumbersAtTheEndsOfTheirRange_HaveAnAnswer) {
  constexpr int64_t kLow = std::numeric_limits<int64_t>::min(), kHigh = std::numeric_limits<int64_t>::max();
  struct {
    int64_t stamp, now;
    ImageFault expected;
  } const cases[] = {{kLow, kLow, ImageFault::kCount},        {kHigh, kHigh, ImageFault::kCount},
                     {kLow + 1, kLow, ImageFault::kCount},    {kLow, kHigh, ImageFault::kStampOld},
                     {kHigh, kLow, ImageFault::kStampFuture}, {kLow, 0, ImageFault::kStampOld},
                     {kLow, -1, ImageFault::kStampOld},       {kHigh, -1, ImageFault::kStampFuture}};
  for (const auto& c : cases) {
    StampCheck check;
    EXPECT_EQ(check.judge(mono(c.stamp), mono(c.now)), c.expected) << c.stamp << " " << c.now;
  }
}

TEST(SequenceCount, AnyFirstNumber_IsZero) {
  for (const uint32_t first : {0U, 7U, 0x7fffffffU, 0xffffffffU}) {
    SequenceCount count;
    const SequenceCount::Step step = count.next(first);
    EXPECT_EQ(step.sequence, 0U);
    EXPECT_EQ(step.lost_before, 0U);
    EXPECT_TRUE(step.first_after_gap);
    EXPECT_EQ(count.next(first + 1).sequence, 1U);
  }
}

TEST(SequenceCount, LossesOverTheWrap_AreExact) {
  for (uint32_t seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    SequenceCount count;
    uint32_t number = 0xffffffffU - 500;
    uint32_t sequence = count.next(number).sequence;
    for (int i = 0; i < 1000; ++i) {
      const uint32_t lost = random() % 3 == 0 ? random() % 5 : 0;
      number += lost + 1;
      sequence += lost + 1;
      const SequenceCount::Step step = count.next(number);
      ASSERT_EQ(step.lost_before, lost) << seed << " " << i;
      ASSERT_EQ(step.sequence, sequence);
      ASSERT_FALSE(step.first_after_gap);
    }
    EXPECT_LT(number, 0x7fffffffU);  // it did wrap
  }
}

TEST(SequenceCount, DriverThatDoesNotCount_IsCountedFor) {
  SequenceCount count;
  for (uint32_t i = 0; i < 10; ++i) {
    const SequenceCount::Step step = count.next(0);
    EXPECT_EQ(step.sequence, i);
    EXPECT_EQ(step.lost_before, 0U);
    EXPECT_EQ(step.first_after_gap, i == 0);
    EXPECT_EQ(step.repeated, i > 0);
  }
}

TEST(SequenceCount, CountedBackwards_IsAGapOfUnknownSize) {
  SequenceCount count;
  count.next(1000);
  count.next(1001);
  const SequenceCount::Step step = count.next(3);
  EXPECT_TRUE(step.first_after_gap);
  EXPECT_EQ(step.lost_before, 0U);
  EXPECT_EQ(step.sequence, 2U);
  EXPECT_FALSE(count.next(4).first_after_gap);
}

}  // namespace
}  // namespace roomcal::drivers
