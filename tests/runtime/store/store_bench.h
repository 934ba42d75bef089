#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/base/arena.h"
#include "runtime/store/store.h"
#include "tests/fakes/power_cut_medium.h"

namespace roomcal::store::test {

inline constexpr std::size_t kPage = 64;
inline constexpr std::size_t kSlotBytes = 1536;

/// A store on an emulated medium, as a device has it.
struct StoreBench {
  explicit StoreBench(std::size_t page = kPage, std::size_t slot_bytes = kSlotBytes)
      : medium(kSlotCount * slot_bytes, page), block(plan_store_bytes(page)), arena(block) {
    const Status opened = store.open(medium, arena);
    EXPECT_TRUE(opened.ok()) << opened.detail();
  }

  /// Power off and on again: the store forgets everything, the medium its cache.
  void restart() {
    medium.power_on();
    store.load();
  }

  fakes::PowerCutMedium medium;
  std::vector<std::byte> block;
  Arena arena;
  Store store;
};

}  // namespace roomcal::store::test
