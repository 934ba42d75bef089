#include "runtime/store/store.h"

#include <gtest/gtest.h>

#include "tests/runtime/store/sample_record.h"
#include "tests/runtime/store/store_bench.h"

namespace roomcal::store {
namespace {

using test::same;
using test::same_content;
using test::sample_record;
using test::StoreBench;

TEST(Store, BlankMedium_IsUncalibratedWithNothing) {
  StoreBench bench;
  EXPECT_EQ(bench.store.state(), State::kUncalibrated);
  EXPECT_EQ(bench.store.current(), nullptr);
  EXPECT_TRUE(bench.store.diagnosis().empty());
  EXPECT_EQ(bench.store.undo(1).code(), StatusCode::kNotFound);
  EXPECT_EQ(bench.store.restore_factory(1).code(), StatusCode::kNotFound);
}

TEST(Store, MediumOfZeros_IsBlankToo) {
  StoreBench bench;
  bench.medium.set_durable(fakes::Image(bench.medium.size_bytes(), std::byte{0}));
  bench.restart();
  EXPECT_EQ(bench.store.state(), State::kUncalibrated);
  EXPECT_TRUE(bench.store.diagnosis().empty());
}

TEST(Store, Commit_SurvivesTheRestart) {
  StoreBench bench;
  ASSERT_TRUE(bench.store.commit(sample_record(1), 77).ok());
  bench.restart();
  ASSERT_EQ(bench.store.state(), State::kCalibrated);
  EXPECT_TRUE(same_content(*bench.store.current(), sample_record(1)));
  EXPECT_EQ(bench.store.current()->generation, 1U);
  EXPECT_EQ(bench.store.current()->written_unix_s, 77);
  EXPECT_EQ(bench.store.current()->previous_content, kNothingBefore);
}

TEST(Store, Commits_AlternateBetweenTheSlots) {
  StoreBench bench;
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    ASSERT_TRUE(bench.store.commit(sample_record(seed), 0).ok());
    EXPECT_EQ(bench.store.source(), seed % 2 == 1 ? Slot::kA : Slot::kB);
    bench.restart();
    EXPECT_EQ(bench.store.source(), seed % 2 == 1 ? Slot::kA : Slot::kB);
    EXPECT_EQ(bench.store.current()->generation, seed);
  }
}

TEST(Store, FailVerdict_IsNotStored) {
  StoreBench bench;
  for (const Verdict verdict : {Verdict::kFailRetry, Verdict::kFailService}) {
    Record record = sample_record(1);
    record.verdict = verdict;
    EXPECT_EQ(bench.store.commit(record, 0).code(), StatusCode::kInvalidArgument);
  }
  EXPECT_EQ(bench.medium.writes(), 0U);
}

TEST(Store, ImpossibleRecord_IsNotStoredAndOldStays) {
  StoreBench bench;
  ASSERT_TRUE(bench.store.commit(sample_record(1), 0).ok());
  Record record = sample_record(2);
  record.sensors[1].T_rig_sensor = SE3();
  EXPECT_EQ(bench.store.commit(record, 0).code(), StatusCode::kCorrupt);
  EXPECT_TRUE(same_content(*bench.store.current(), sample_record(1)));
}

TEST(Store, Provision_OnceAndInForceUntilCalibrated) {
  StoreBench bench;
  ASSERT_TRUE(bench.store.provision(sample_record(100), 5).ok());
  EXPECT_EQ(bench.store.state(), State::kFactory);
  EXPECT_EQ(bench.store.provision(sample_record(101), 6).code(), StatusCode::kInvalidArgument);
  bench.restart();
  ASSERT_EQ(bench.store.state(), State::kFactory);
  EXPECT_TRUE(same_content(*bench.store.current(), sample_record(100)));
  ASSERT_TRUE(bench.store.commit(sample_record(1), 7).ok());
  bench.restart();
  EXPECT_EQ(bench.store.state(), State::kCalibrated);
  EXPECT_EQ(bench.store.current()->previous_content, kFactoryContent);
}

TEST(Store, Undo_GoesBackStepByStepWithNewGenerations) {
  StoreBench bench;
  ASSERT_TRUE(bench.store.provision(sample_record(100), 0).ok());
  for (uint64_t seed = 1; seed <= 3; ++seed) ASSERT_TRUE(bench.store.commit(sample_record(seed), 0).ok());
  for (const uint64_t expected : {2U, 1U, 100U}) {
    ASSERT_TRUE(bench.store.undo(9).ok());
    bench.restart();
    EXPECT_TRUE(same_content(*bench.store.current(), sample_record(expected)));
    EXPECT_EQ(bench.store.current()->action, Action::kUndone);
  }
  EXPECT_EQ(bench.store.current()->generation, 6U);
  EXPECT_EQ(bench.store.undo(9).code(), StatusCode::kNotFound);
}

TEST(Store, CalibrateAfterUndo_UndoesToWhatWasInForce) {
  StoreBench bench;
  for (uint64_t seed = 1; seed <= 2; ++seed) ASSERT_TRUE(bench.store.commit(sample_record(seed), 0).ok());
  ASSERT_TRUE(bench.store.undo(0).ok());
  ASSERT_TRUE(bench.store.commit(sample_record(3), 0).ok());
  ASSERT_TRUE(bench.store.undo(0).ok());
  EXPECT_TRUE(same_content(*bench.store.current(), sample_record(1)));
}

TEST(Store, UndoBeyondTheHistory_SaysSo) {
  StoreBench bench;
  for (uint64_t seed = 1; seed <= 20; ++seed) ASSERT_TRUE(bench.store.commit(sample_record(seed), 0).ok());
  Status status = ok_status();
  int steps = 0;
  while ((status = bench.store.undo(0)).ok()) ++steps;
  EXPECT_EQ(status.code(), StatusCode::kNotFound);
  EXPECT_GE(steps, 4);  // every undo takes a place of the ring itself
  EXPECT_EQ(bench.store.state(), State::kCalibrated);
}

TEST(Store, RestoreFactory_AndUndoOfIt) {
  StoreBench bench;
  ASSERT_TRUE(bench.store.provision(sample_record(100), 0).ok());
  ASSERT_TRUE(bench.store.commit(sample_record(1), 0).ok());
  ASSERT_TRUE(bench.store.restore_factory(0).ok());
  bench.restart();
  EXPECT_TRUE(same_content(*bench.store.current(), sample_record(100)));
  EXPECT_EQ(bench.store.current()->action, Action::kFactoryRestored);
  ASSERT_TRUE(bench.store.undo(0).ok());
  EXPECT_TRUE(same_content(*bench.store.current(), sample_record(1)));
}

TEST(Store, List_HoldsTheLastEightBeforeThePresent) {
  StoreBench bench;
  ASSERT_TRUE(bench.store.provision(sample_record(100), 0).ok());
  for (uint64_t seed = 1; seed <= 12; ++seed) ASSERT_TRUE(bench.store.commit(sample_record(seed), 0).ok());
  History history;
  bench.store.list(history);
  ASSERT_EQ(history.size(), 1 + kHistoryLength + 1);  // in force, eight before, factory
  for (std::size_t i = 0; i <= kHistoryLength; ++i) EXPECT_EQ(history[i].generation, 12 - i);
  EXPECT_EQ(history.back().slot, Slot::kFactory);
  EXPECT_TRUE(history[0].in_force);
  EXPECT_FALSE(history[1].in_force);
  Record record;
  ASSERT_TRUE(bench.store.read_generation(7, record).ok());
  EXPECT_TRUE(same_content(record, sample_record(7)));
  EXPECT_EQ(bench.store.read_generation(3, record).code(), StatusCode::kNotFound);
}

TEST(Store, AnotherDevicesRecord_IsForeign) {
  StoreBench bench;
  ASSERT_TRUE(bench.store.commit(sample_record(1), 0).ok());
  std::vector<std::byte> block(plan_store_bytes(test::kPage));
  Arena arena(block);
  Store other;
  ASSERT_TRUE(other.open(bench.medium, arena, "robot-8").ok());
  EXPECT_EQ(other.state(), State::kUncalibrated);
  EXPECT_EQ(other.conditions()[static_cast<std::size_t>(Slot::kA)], SlotCondition::kForeign);
  EXPECT_NE(other.diagnosis().view().find("slot A: another device's record"), std::string_view::npos);
  EXPECT_EQ(other.commit(sample_record(2), 0).code(), StatusCode::kInvalidArgument);
}

TEST(Store, RecordLargerThanASlot_IsCapacityAndOldStays) {
  StoreBench bench(64, 1536);
  ASSERT_TRUE(bench.store.commit(sample_record(1), 0).ok());
  EXPECT_EQ(bench.store.commit(sample_record(2, 8), 0).code(), StatusCode::kCapacity);
  bench.restart();
  EXPECT_TRUE(same_content(*bench.store.current(), sample_record(1)));
}

TEST(Store, PageSizes_AllWork) {
  for (const std::size_t page : {1U, 8U, 64U, 256U, 512U, 4096U, 65536U}) {
    StoreBench bench(page, page > 2048 ? page : 2048);
    ASSERT_TRUE(bench.store.commit(sample_record(1), 0).ok()) << page;
    ASSERT_TRUE(bench.store.commit(sample_record(2), 0).ok()) << page;
    bench.restart();
    EXPECT_TRUE(same_content(*bench.store.current(), sample_record(2))) << page;
    EXPECT_LE(bench.arena.peak(), plan_store_bytes(page));
  }
}

TEST(Store, ImpossibleMedium_IsRefused) {
  std::vector<std::byte> block(plan_store_bytes(64));
  const auto open = [&](std::size_t size, std::size_t page) {
    fakes::PowerCutMedium medium(size, page);
    Arena arena(block);
    Store store;
    return store.open(medium, arena).code();
  };
  EXPECT_EQ(open(64 * 1024, 48), StatusCode::kInvalidArgument);
  EXPECT_EQ(open(1 << 20, 1 << 17), StatusCode::kInvalidArgument);
  EXPECT_EQ(open(kSlotCount * 1024 - 64, 64), StatusCode::kCapacity);
  EXPECT_EQ(open(kSlotCount * 1024, 64), StatusCode::kOk);
}

TEST(Store, EveryRefusedArenaRequest_IsOutOfMemory) {
  fakes::PowerCutMedium medium(kSlotCount * 1536, 64);
  std::vector<std::byte> block(plan_store_bytes(64));
  std::size_t refused = 0;
  for (std::size_t size = 0; size <= block.size(); size += 512) {
    Arena arena({block.data(), size});
    Store store;
    const Status opened = store.open(medium, arena);
    if (opened.ok()) continue;
    EXPECT_EQ(opened.code(), StatusCode::kOutOfMemory);
    ++refused;
  }
  EXPECT_GT(refused, 4U);
}

}  // namespace
}  // namespace roomcal::store
