#include "runtime/grab/image_ring.h"

#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace roomcal::grab {
namespace {

constexpr int kWidth = 8, kHeight = 4;

/// A ring with its memory; images are filled with one grey level.
struct Bench {
  explicit Bench(std::size_t slots) : memory(ImageRing::bytes(kWidth, kHeight, slots)), arena(memory) {
    EXPECT_TRUE(ring.create(kWidth, kHeight, slots, arena).ok());
  }
  bool write(uint8_t grey, int64_t exposed_ns) {
    const MutableImageView place = ring.begin_write();
    if (place.empty()) return false;
    for (int y = 0; y < kHeight; ++y) std::fill_n(place.row(y), kWidth, grey);
    ports::ImageFacts facts;
    facts.sequence = grey;
    ring.publish(facts, {exposed_ns, 5});
    return true;
  }
  std::vector<std::byte> memory;
  Arena arena;
  ImageRing ring;
};

TEST(ImageRing, Create_RefusesWhatIsNoRing) {
  std::vector<std::byte> memory(ImageRing::bytes(kWidth, kHeight, 2));
  Arena arena(memory);
  Arena small(std::span<std::byte>(memory).first(10));
  ImageRing ring;
  EXPECT_EQ(ring.create(0, kHeight, 2, arena).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(ring.create(kWidth, kHeight, 1, arena).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(ring.create(kWidth, kHeight, kMaxSlots + 1, arena).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(ring.create(kWidth, kHeight, 2, small).code(), StatusCode::kOutOfMemory);
  EXPECT_TRUE(ring.create(kWidth, kHeight, 2, arena).ok());
}

TEST(ImageRing, NothingWritten_NothingToHold) {
  Bench bench(3);
  EXPECT_TRUE(bench.ring.hold_since(0).empty());
}

TEST(ImageRing, Hold_NewestFirstAndNoneFromBefore) {
  Bench bench(4);
  for (uint8_t i = 1; i <= 4; ++i) bench.write(i, 100 * i);
  const auto held = bench.ring.hold_since(300);
  ASSERT_EQ(held.size(), 2U);
  EXPECT_EQ(held[0].facts.sequence, 4U);
  EXPECT_EQ(held[0].time.exposed_ns, 400);
  EXPECT_EQ(held[0].time.uncertainty_ns, 5);
  EXPECT_EQ(held[1].facts.sequence, 3U);
  EXPECT_EQ(held[1].luma(kWidth - 1, kHeight - 1), 3);
}

TEST(ImageRing, TwoSlots_WriterGoesOnWhileOneIsHeld) {
  Bench bench(2);
  bench.write(1, 100);
  const auto held = bench.ring.hold_since(0);
  ASSERT_EQ(held.size(), 1U);
  for (uint8_t i = 2; i < 10; ++i) EXPECT_TRUE(bench.write(i, 100 * i));
  EXPECT_EQ(held[0].luma(0, 0), 1) << "nobody writes into what is held";
  EXPECT_TRUE(bench.ring.hold_since(0).empty()) << "one must be left to the writer";
  bench.ring.release(held[0]);
  const auto again = bench.ring.hold_since(0);
  ASSERT_EQ(again.size(), 1U);
  EXPECT_EQ(again[0].facts.sequence, 9U);
}

TEST(ImageRing, OldestIsOverwrittenFirst) {
  Bench bench(3);
  for (uint8_t i = 1; i <= 5; ++i) bench.write(i, i);
  const auto held = bench.ring.hold_since(0);
  ASSERT_EQ(held.size(), 2U);
  EXPECT_EQ(held[0].facts.sequence, 5U);
  EXPECT_EQ(held[1].facts.sequence, 4U);
}

TEST(ImageRing, AbandonedImage_IsNotSeen) {
  Bench bench(2);
  bench.write(1, 1);
  ASSERT_FALSE(bench.ring.begin_write().empty());
  bench.ring.abandon();
  const auto held = bench.ring.hold_since(0);
  ASSERT_EQ(held.size(), 1U);
  EXPECT_EQ(held[0].facts.sequence, 1U);
}

TEST(ImageRing, ReleasedTwice_CountsOnce) {
  Bench bench(2);
  bench.write(1, 1);
  const auto held = bench.ring.hold_since(0);
  ASSERT_EQ(held.size(), 1U);
  bench.ring.release(held[0]);
  bench.ring.release(held[0]);
  EXPECT_EQ(bench.ring.hold_since(0).size(), 1U);
}

TEST(ImageRing, TwoThreads_HeldImagesAreWholeAndInOrder) {
  Bench bench(3);
  std::atomic<bool> stop{false};
  std::thread writer([&] {
    for (uint32_t i = 1; !stop; ++i) bench.write(static_cast<uint8_t>(i), i);
  });
  int seen = 0;
  bool whole = true, ordered = true;
  int64_t last_ns = 0;
  while (seen < 20'000) {
    const auto held = bench.ring.hold_since(last_ns);
    for (std::size_t k = 0; k < held.size(); ++k) {
      const auto grey = static_cast<uint8_t>(held[k].time.exposed_ns);
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) whole = whole && held[k].luma(x, y) == grey;
      whole = whole && held[k].facts.sequence == grey;
      ordered = ordered && held[k].time.exposed_ns >= last_ns;
    }
    if (!held.empty()) last_ns = held[0].time.exposed_ns;
    for (std::size_t k = 0; k < held.size(); ++k) bench.ring.release(held[k]);
    seen += static_cast<int>(held.size());
  }
  stop = true;
  writer.join();
  EXPECT_TRUE(whole);
  EXPECT_TRUE(ordered);
}

}  // namespace
}  // namespace roomcal::grab
