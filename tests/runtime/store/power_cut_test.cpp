// Power cuts during a commit: at every operation and every byte of it, with whole, torn, reordered and lost pages, and
// once more during the commit after the restart. load() may give the old or the new record, never anything else.

#include <cstdio>
#include <functional>

#include "tests/runtime/store/sample_record.h"
#include "tests/runtime/store/store_bench.h"
#include "tests/truth/random.h"

namespace roomcal::store {
namespace {

using fakes::Image;
using fakes::MediumOp;
using test::kPage;
using test::same;
using test::sample_record;
using test::StoreBench;

// All second cuts after every first cut take a minute under the sanitizers; there, different first cuts take different
// bytes.
#ifdef __SANITIZE_ADDRESS__
constexpr std::size_t kSecondCutStride = 8;
#else
constexpr std::size_t kSecondCutStride = 1;
#endif

using Visit = std::function<void(const Image&)>;

void put(Image& image, const MediumOp& op, std::size_t first, std::size_t count) {
  std::copy_n(op.page.begin() + static_cast<std::ptrdiff_t>(first), count,
              image.begin() + static_cast<std::ptrdiff_t>(op.offset + first));
}

// How a page that was being written when power went may look: its beginning new, its end new, or its beginning new and
// the rest erased (an EEPROM erases before it programs).
void visit_torn(const Image& before, const MediumOp& op, std::size_t byte, const Visit& visit) {
  Image image = before;
  put(image, op, 0, byte);
  visit(image);
  std::fill(image.begin() + static_cast<std::ptrdiff_t>(op.offset + byte),
            image.begin() + static_cast<std::ptrdiff_t>(op.offset + op.page.size()), std::byte{0xFF});
  visit(image);
  image = before;
  put(image, op, byte, op.page.size() - byte);
  visit(image);
}

// Every byte of every write, all earlier writes having arrived; with a stride, only bytes phase, phase + stride, ...
void visit_every_byte(const Image& start, const std::vector<MediumOp>& trace, const Visit& visit,
                      std::size_t stride = 1, std::size_t phase = 0) {
  Image image = start;
  for (const MediumOp& op : trace) {
    if (op.kind == MediumOp::Kind::kSync) continue;
    for (std::size_t byte = phase; byte < op.page.size(); byte += stride) visit_torn(image, op, byte, visit);
    put(image, op, 0, op.page.size());
  }
  visit(image);
}

// Of the pages written since the last sync, any set may have arrived: all sets while they are few, else drawn ones,
// every other time with one page torn.
void visit_any_order(const Image& start, const std::vector<MediumOp>& trace, std::size_t few, const Visit& visit) {
  truth::Random random(7);
  Image synced = start;
  std::vector<const MediumOp*> open;
  for (const MediumOp& op : trace) {
    if (op.kind == MediumOp::Kind::kSync) {
      for (const MediumOp* pending : open) put(synced, *pending, 0, pending->page.size());
      open.clear();
      continue;
    }
    open.push_back(&op);
    const std::size_t sets = std::size_t{1} << std::min(open.size(), few);
    for (std::size_t drawn = 0; drawn < sets; ++drawn) {
      const uint64_t chosen = open.size() <= few ? drawn : random.bits();
      Image image = synced;
      for (std::size_t i = 0; i < open.size(); ++i)
        if ((chosen >> i & 1U) != 0) put(image, *open[i], 0, open[i]->page.size());
      if (drawn % 2 == 1) put(image, *open[random.index(open.size())], 0, random.index(kPage));
      visit(image);
    }
  }
}

// Commits `record` on the image and returns what was asked of the medium.
std::vector<MediumOp> trace_of_commit(StoreBench& bench, const Image& image, const Record& record) {
  bench.medium.set_durable(image);
  bench.store.load();
  bench.medium.set_script({});
  EXPECT_TRUE(bench.store.commit(record, 5).ok());
  return bench.medium.trace();
}

class PowerCut : public testing::Test {
 protected:
  // A store with a factory record and three measured ones, so that both slots and the history are in use.
  void SetUp() override {
    ASSERT_TRUE(bench.store.provision(sample_record(100), 1).ok());
    for (uint64_t seed = 1; seed <= 3; ++seed) ASSERT_TRUE(bench.store.commit(sample_record(seed), 2).ok());
    old_record = *bench.store.current();
    start = bench.medium.durable();
    trace = trace_of_commit(bench, start, sample_record(4));
    new_record = *bench.store.current();
    ASSERT_EQ(new_record.generation, 4U);
  }

  // Restart on this image; which of the two is in force? Counts a violation for anything else.
  const Record* load(const Image& image, const Record& older, const Record& newer) {
    ++cases;
    bench.medium.set_durable(image);
    bench.store.load();
    const Record* loaded = bench.store.current();
    if (loaded != nullptr && (same(*loaded, older) || same(*loaded, newer))) return loaded;
    ++violations;
    return nullptr;
  }

  StoreBench bench;
  Record old_record, new_record;
  Image start;
  std::vector<MediumOp> trace;
  std::size_t cases = 0, violations = 0;
};

TEST_F(PowerCut, AnyByteOfACommit_OldOrNewRecord) {
  std::size_t old_seen = 0, new_seen = 0;
  visit_every_byte(start, trace, [&](const Image& image) {
    const Record* loaded = load(image, old_record, new_record);
    if (loaded != nullptr) ++(loaded->generation == old_record.generation ? old_seen : new_seen);
  });
  std::printf("power cuts at every byte: %zu cases, %zu old, %zu new, %zu violations\n", cases, old_seen, new_seen,
              violations);
  EXPECT_EQ(violations, 0U);
  EXPECT_GT(old_seen, 1000U);
  EXPECT_GT(new_seen, 0U);
}

TEST_F(PowerCut, UnsyncedPagesInAnyOrder_OldOrNewRecord) {
  visit_any_order(start, trace, 12, [&](const Image& image) { load(image, old_record, new_record); });
  std::printf("power cuts with reordered, lost and torn pages: %zu cases, %zu violations\n", cases, violations);
  EXPECT_EQ(violations, 0U);
}

TEST_F(PowerCut, TwoCutsInARow_OldOrNewRecord) {
  // First cuts: every page, torn in its middle in three ways, and some orders. Different images only.
  std::vector<Image> first_cuts;
  const auto keep = [&](const Image& image) {
    if (std::find(first_cuts.begin(), first_cuts.end(), image) == first_cuts.end()) first_cuts.push_back(image);
  };
  Image image = start;
  for (const MediumOp& op : trace) {
    if (op.kind == MediumOp::Kind::kSync) continue;
    visit_torn(image, op, kPage / 2, keep);
    put(image, op, 0, op.page.size());
  }
  visit_any_order(start, trace, 1, keep);
  keep(image);

  const Record third = sample_record(5);
  std::size_t distinct = 0, first_cut = 0;
  for (const Image& cut : first_cuts) {
    const Record* survivor = load(cut, old_record, new_record);
    ASSERT_NE(survivor, nullptr);
    const Record older = *survivor;
    const std::vector<MediumOp> again = trace_of_commit(bench, cut, third);
    const Record newer = *bench.store.current();
    distinct += older.generation == old_record.generation ? 0 : 1;
    const Visit check = [&](const Image& second) { load(second, older, newer); };
    visit_every_byte(cut, again, check, kSecondCutStride, first_cut++ % kSecondCutStride);
    visit_any_order(cut, again, 5, check);
  }
  std::printf("two power cuts in a row: %zu first cuts (%zu after the new record), %zu cases, %zu violations\n",
              first_cuts.size(), distinct, cases, violations);
  EXPECT_EQ(violations, 0U);
  EXPECT_GE(cases, 100'000U);
}

TEST_F(PowerCut, DuringTheCommitItself_IsNotAcknowledgedAndLeavesOld) {
  for (std::size_t op = 0; op < trace.size(); ++op) {
    for (const std::size_t byte : {std::size_t{0}, std::size_t{1}, kPage / 2, kPage - 1}) {
      bench.medium.set_durable(start);
      bench.store.load();
      fakes::MediumScript script;
      script.cut_op = op;
      script.cut_byte = byte;
      bench.medium.set_script(script);
      EXPECT_FALSE(bench.store.commit(sample_record(4), 5).ok()) << "operation " << op;
      EXPECT_TRUE(same(*bench.store.current(), old_record)) << "operation " << op;
      bench.restart();
      EXPECT_TRUE(same(*bench.store.current(), old_record)) << "operation " << op;
    }
  }
}

TEST_F(PowerCut, RightAfterTheAcknowledgement_NewRecord) {
  bench.medium.set_durable(start);
  bench.store.load();
  ASSERT_TRUE(bench.store.commit(sample_record(4), 5).ok());
  bench.restart();
  EXPECT_TRUE(same(*bench.store.current(), new_record));
}

TEST_F(PowerCut, DuringProvisioning_FactoryOrUncalibrated) {
  StoreBench fresh;
  ASSERT_TRUE(fresh.store.provision(sample_record(100), 1).ok());
  const std::vector<MediumOp> provisioning = fresh.medium.trace();
  const Image blank(fresh.medium.size_bytes(), std::byte{0xFF});
  std::size_t factory = 0;
  visit_every_byte(blank, provisioning, [&](const Image& image) {
    bench.medium.set_durable(image);
    bench.store.load();
    factory += bench.store.state() == State::kFactory ? 1 : 0;
    EXPECT_NE(bench.store.state(), State::kCalibrated);
    EXPECT_EQ(bench.store.current() == nullptr, bench.store.state() == State::kUncalibrated);
  });
  EXPECT_GT(factory, 0U);
}

}  // namespace
}  // namespace roomcal::store
