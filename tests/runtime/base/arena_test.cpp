#include "runtime/base/arena.h"

#include <array>
#include <cstdint>

#include <gtest/gtest.h>

namespace roomcal {
namespace {

TEST(Arena, AllocationsOfMixedTypes_AreAlignedAndApart) {
  alignas(16) std::array<std::byte, 256> bytes;
  Arena arena(bytes);
  const auto chars = arena.allocate<char>(3);
  const auto doubles = arena.allocate<double>(2);
  ASSERT_EQ(chars.size(), 3u);
  ASSERT_EQ(doubles.size(), 2u);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(doubles.data()) % alignof(double), 0u);
  EXPECT_GE(reinterpret_cast<char*>(doubles.data()), chars.data() + 3);
  EXPECT_EQ(doubles[0], 0.0);
}

TEST(Arena, RequestBeyondCapacity_IsRefusedAndCounted) {
  std::array<std::byte, 32> bytes;
  Arena arena(bytes);
  EXPECT_TRUE(arena.allocate<double>(5).empty());
  EXPECT_EQ(arena.refusals(), 1u);
  EXPECT_EQ(arena.used(), 0u);
  EXPECT_TRUE(arena.allocate<double>(SIZE_MAX / 4).empty());
  EXPECT_EQ(arena.refusals(), 2u);
}

TEST(Arena, Scope_GivesBackAndPeakRemembers) {
  alignas(8) std::array<std::byte, 128> bytes;
  Arena arena(bytes);
  {
    Arena::Scope scope(arena);
    EXPECT_EQ(arena.allocate<double>(8).size(), 8u);
  }
  EXPECT_EQ(arena.used(), 0u);
  EXPECT_EQ(arena.peak(), 64u);
}

TEST(Arena, Sealed_RefusesWhateverIsAsked) {
  std::array<std::byte, 64> bytes;
  Arena arena(bytes);
  arena.seal();
  EXPECT_TRUE(arena.allocate<char>(1).empty());
  EXPECT_EQ(arena.refusals(), 1u);
}

TEST(Arenas, BlockSmallerThanItsParts_IsOutOfMemory) {
  std::array<std::byte, 64> bytes;
  EXPECT_EQ(Arenas::carve(bytes, 40, 40).status().code(), StatusCode::kOutOfMemory);
  const auto arenas = Arenas::carve(bytes, 16, 16);
  ASSERT_TRUE(arenas.ok());
  EXPECT_EQ(arenas.value().step.capacity(), 32u);
}

}  // namespace
}  // namespace roomcal
