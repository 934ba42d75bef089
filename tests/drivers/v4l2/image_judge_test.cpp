#include "drivers/v4l2/image_judge.h"

#include <vector>

#include <gtest/gtest.h>

namespace roomcal::drivers {
namespace {

using ports::ImageFault;

constexpr int64_t kMs = 1'000'000, kS = 1'000'000'000;

class ImageJudgeTest : public testing::Test {
 protected:
  ImageJudgeTest() { judge.begin(100, {.period_ns = 33 * kMs, .exposure_ns = 0}, now_ns); }

  FilledBuffer image(uint32_t sequence, int64_t stamp_ns) const {
    FilledBuffer filled;
    filled.bytes = bytes;
    filled.sequence = sequence;
    filled.stamp = {stamp_ns, ClockId::kMonotonic};
    return filled;
  }

  std::vector<std::byte> bytes = std::vector<std::byte>(100);
  ImageJudge judge;
  int64_t now_ns = 500 * kS;
};

TEST_F(ImageJudgeTest, LossesAddUpUntilTheyAreTold) {
  const auto lost = [&](uint32_t sequence) {
    now_ns += 33 * kMs;
    judge.seen_empty(now_ns - kMs);
    return judge.judge(image(sequence, now_ns), now_ns).facts.lost_before;
  };
  EXPECT_EQ(lost(7), 0U);
  judge.told();
  EXPECT_EQ(lost(10), 2U);  // put back for a newer one
  EXPECT_EQ(lost(14), 5U);
  judge.told();
  EXPECT_EQ(lost(15), 0U);
}

TEST_F(ImageJudgeTest, DamagedImage_TakesItsNumberAndIsNotLost) {
  judge.judge(image(0, now_ns), now_ns);
  judge.told();
  FilledBuffer damaged = image(1, now_ns + kMs);
  damaged.damaged = true;
  const Judgement dropped = judge.judge(damaged, now_ns + kMs);
  EXPECT_EQ(dropped.fault, ImageFault::kMarkedDamaged);
  EXPECT_FALSE(dropped.keep);
  EXPECT_FALSE(dropped.backlog);
  EXPECT_EQ(judge.judge(image(2, now_ns + 2 * kMs), now_ns + 2 * kMs).facts.lost_before, 0U);
}

TEST_F(ImageJudgeTest, OneByteShort_IsDropped) {
  FilledBuffer cut = image(0, now_ns);
  cut.bytes = cut.bytes.first(99);
  EXPECT_EQ(judge.judge(cut, now_ns).fault, ImageFault::kShort);
  EXPECT_FALSE(judge.judge(cut, now_ns).keep);
}

TEST_F(ImageJudgeTest, OldStamp_IsAFaultWhereSomebodyAskedAndBacklogWhereNobodyDid) {
  Judgement judged = judge.judge(image(0, now_ns - 2 * kS), now_ns);
  EXPECT_EQ(judged.fault, ImageFault::kStampOld);
  EXPECT_FALSE(judged.keep || judged.backlog);
  now_ns += 5 * kS;
  judged = judge.judge(image(1, now_ns - 2 * kS), now_ns);
  EXPECT_EQ(judged.fault, ImageFault::kCount);
  EXPECT_TRUE(judged.backlog);
  EXPECT_FALSE(judged.keep);
}

TEST_F(ImageJudgeTest, FreshImageAfterAPause_IsKeptAndMarked) {
  judge.judge(image(0, now_ns), now_ns);
  judge.told();
  now_ns += 5 * kS;
  const Judgement judged = judge.judge(image(150, now_ns - 10 * kMs), now_ns);
  EXPECT_TRUE(judged.keep);
  EXPECT_TRUE(judged.facts.first_after_gap);
  EXPECT_EQ(judged.facts.lost_before, 0U);
}

TEST_F(ImageJudgeTest, UnknownClock_StartLiesBetweenTheLastLookAndNow) {
  FilledBuffer unknown = image(0, 12345);
  unknown.stamp.clock = ClockId::kUnknown;
  judge.seen_empty(now_ns);
  const Judgement judged = judge.judge(unknown, now_ns + 20 * kMs);
  EXPECT_EQ(judged.fault, ImageFault::kStampUnknown);
  EXPECT_TRUE(judged.keep);
  // Complete within [now, now + 20 ms], begun up to two periods before.
  EXPECT_EQ(judged.facts.exposed.ns - judged.facts.uncertainty_ns, now_ns - 66 * kMs);
  EXPECT_EQ(judged.facts.exposed.ns + judged.facts.uncertainty_ns, now_ns + 20 * kMs);
}

TEST_F(ImageJudgeTest, PeriodUnknown_AWideOneIsSupposed) {
  judge.begin(100, {}, now_ns);
  EXPECT_EQ(judge.judge(image(0, now_ns), now_ns).facts.uncertainty_ns, 100 * kMs);
}

TEST_F(ImageJudgeTest, NewStream_HasNoPast) {
  judge.judge(image(900, now_ns), now_ns);
  judge.told();
  judge.begin(100, {.period_ns = 33 * kMs, .exposure_ns = 0}, now_ns);
  const Judgement judged = judge.judge(image(3, now_ns - 20 * kMs), now_ns);
  EXPECT_EQ(judged.fault, ImageFault::kCount);
  EXPECT_EQ(judged.facts.sequence, 0U);
  EXPECT_TRUE(judged.facts.first_after_gap);
}

}  // namespace
}  // namespace roomcal::drivers
