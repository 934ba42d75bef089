// Media that fail, lie and rot while the power stays on: the old record stays in force or the new one is there, and the
// trouble has a name.

#include <gtest/gtest.h>

#include "tests/runtime/store/sample_record.h"
#include "tests/runtime/store/store_bench.h"

namespace roomcal::store {
namespace {

using fakes::kNever;
using fakes::MediumScript;
using test::kSlotBytes;
using test::same_content;
using test::sample_record;
using test::StoreBench;

std::size_t byte_of(Slot slot, std::size_t at) { return static_cast<std::size_t>(slot) * kSlotBytes + at; }

// Fails the n-th operation of one kind, for every n, until the commit passes without meeting the failure.
void walk(std::size_t MediumScript::*what, bool from_then_on) {
  for (std::size_t n = 0;; ++n) {
    ASSERT_LT(n, 1000U);
    StoreBench bench;
    for (uint64_t seed = 1; seed <= 2; ++seed) ASSERT_TRUE(bench.store.commit(sample_record(seed), 0).ok());
    MediumScript script;
    script.*what = n;
    script.from_then_on = from_then_on;
    bench.medium.set_script(script);
    const bool acknowledged = bench.store.commit(sample_record(3), 0).ok();
    const bool met = n < std::max({bench.medium.reads(), bench.medium.writes(), bench.medium.syncs()});
    const Record in_force = *bench.store.current();
    EXPECT_TRUE(same_content(in_force, sample_record(acknowledged ? 3 : 2))) << "operation " << n;
    bench.restart();
    ASSERT_NE(bench.store.current(), nullptr) << "operation " << n;
    // Where the medium fails for ever, the slot could not be erased either: the new record may then be there after all.
    const bool is_old = same_content(*bench.store.current(), sample_record(2));
    const bool is_new = same_content(*bench.store.current(), sample_record(3));
    const bool may_be_old = !acknowledged, may_be_new = acknowledged || from_then_on;
    EXPECT_TRUE((is_old && may_be_old) || (is_new && may_be_new)) << "operation " << n;
    if (!met) {
      EXPECT_TRUE(acknowledged);
      return;
    }
  }
}

TEST(MediaTrouble, NthWriteFails_OldOrNew) { walk(&MediumScript::fail_write, false); }
TEST(MediaTrouble, WritesFailForEver_OldOrNew) { walk(&MediumScript::fail_write, true); }
TEST(MediaTrouble, NthReadFails_OldOrNew) { walk(&MediumScript::fail_read, false); }
TEST(MediaTrouble, ReadsFailForEver_OldOrNew) { walk(&MediumScript::fail_read, true); }
TEST(MediaTrouble, NthSyncFails_OldOrNew) { walk(&MediumScript::fail_sync, false); }
TEST(MediaTrouble, SyncsFailForEver_OldOrNew) { walk(&MediumScript::fail_sync, true); }
TEST(MediaTrouble, NthWriteIsLost_OldOrNew) { walk(&MediumScript::lose_write, false); }
TEST(MediaTrouble, WritesAreLostForEver_OldOrNew) { walk(&MediumScript::lose_write, true); }
TEST(MediaTrouble, NthWriteHasAWrongBit_OldOrNew) { walk(&MediumScript::flip_write, false); }
TEST(MediaTrouble, WritesHaveWrongBits_OldOrNew) { walk(&MediumScript::flip_write, true); }

TEST(MediaTrouble, WriteThatOnlyReachesTheCache_IsNotAcknowledged) {
  StoreBench bench;
  MediumScript script;
  script.lose_write = 3;
  bench.medium.set_script(script);
  EXPECT_EQ(bench.store.commit(sample_record(1), 0).code(), StatusCode::kCorrupt);
  EXPECT_EQ(bench.store.state(), State::kUncalibrated);
}

TEST(MediaTrouble, RotInTheNewestSlot_GivesTheOneBeforeWithAName) {
  for (std::size_t at = 0; at < 900; at += 7) {
    StoreBench bench;
    for (uint64_t seed = 1; seed <= 2; ++seed) ASSERT_TRUE(bench.store.commit(sample_record(seed), 0).ok());
    bench.medium.durable_byte(byte_of(Slot::kB, at)) ^= std::byte{1};
    bench.restart();
    ASSERT_EQ(bench.store.state(), State::kCalibrated);
    EXPECT_TRUE(same_content(*bench.store.current(), sample_record(1))) << at;
    EXPECT_NE(bench.store.diagnosis().view().find("slot B: torn or damaged"), std::string_view::npos) << at;
  }
}

TEST(MediaTrouble, BothSlotsDamaged_HistoryThenFactoryThenUncalibrated) {
  StoreBench bench;
  ASSERT_TRUE(bench.store.provision(sample_record(100), 0).ok());
  for (uint64_t seed = 1; seed <= 3; ++seed) ASSERT_TRUE(bench.store.commit(sample_record(seed), 0).ok());
  const auto damage = [&](Slot slot) { bench.medium.durable_byte(byte_of(slot, 100)) ^= std::byte{1}; };
  damage(Slot::kA);
  damage(Slot::kB);
  bench.restart();
  ASSERT_EQ(bench.store.state(), State::kCalibrated);
  EXPECT_TRUE(same_content(*bench.store.current(), sample_record(2)));
  EXPECT_EQ(bench.store.diagnosis().view(),
            "slot A: torn or damaged content, slot B: torn or damaged content; in force: history 2");
  for (std::size_t i = 0; i < kHistoryLength; ++i) damage(history_slot(i));
  bench.restart();
  EXPECT_EQ(bench.store.state(), State::kFactory);
  damage(Slot::kFactory);
  bench.restart();
  EXPECT_EQ(bench.store.state(), State::kUncalibrated);
  EXPECT_EQ(bench.store.current(), nullptr);
  EXPECT_NE(bench.store.diagnosis().view().find("slot factory: torn or damaged content"), std::string_view::npos);
}

TEST(MediaTrouble, SlotsThatComeBackAfterACommit_DoNotOutrankIt) {
  StoreBench bench;
  for (uint64_t seed = 1; seed <= 6; ++seed) ASSERT_TRUE(bench.store.commit(sample_record(seed), 0).ok());
  // Both slots and the history cannot be read for a while; the device is calibrated anew in that state.
  MediumScript script;
  script.fail_read = 0;
  script.from_then_on = true;
  bench.medium.set_script(script);
  bench.store.load();
  ASSERT_EQ(bench.store.state(), State::kUncalibrated);
  bench.medium.set_script({});
  ASSERT_TRUE(bench.store.commit(sample_record(7), 0).ok());
  bench.restart();
  EXPECT_TRUE(same_content(*bench.store.current(), sample_record(7)));
}

TEST(MediaTrouble, ReadErrorOfOneSlot_UsesTheOther) {
  StoreBench bench;
  for (uint64_t seed = 1; seed <= 2; ++seed) ASSERT_TRUE(bench.store.commit(sample_record(seed), 0).ok());
  MediumScript script;
  script.fail_read = 0;  // slot A's header
  bench.medium.set_script(script);
  bench.store.load();
  EXPECT_TRUE(same_content(*bench.store.current(), sample_record(2)));
  EXPECT_NE(bench.store.diagnosis().view().find("slot A: read error"), std::string_view::npos);
}

TEST(MediaTrouble, ForeignBytes_AreNamed) {
  StoreBench bench;
  fakes::Image image(bench.medium.size_bytes());
  for (std::size_t i = 0; i < image.size(); ++i) image[i] = static_cast<std::byte>(i * 31 % 251);
  bench.medium.set_durable(image);
  bench.restart();
  EXPECT_EQ(bench.store.state(), State::kUncalibrated);
  EXPECT_NE(bench.store.diagnosis().view().find("slot A: torn or damaged header"), std::string_view::npos);
  ASSERT_TRUE(bench.store.commit(sample_record(1), 0).ok());
  bench.restart();
  EXPECT_TRUE(same_content(*bench.store.current(), sample_record(1)));
}

}  // namespace
}  // namespace roomcal::store
