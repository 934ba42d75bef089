#pragma once

#include <cstddef>

#include "runtime/base/status.h"
#include "runtime/ports/medium.h"

namespace roomcal::store {

/// Which slot of the medium. On it they follow each other in this order, from offset 0.
enum class Slot : std::size_t { kFactory, kA, kB, kHistory0 };

inline constexpr std::size_t kHistoryLength = 8;
inline constexpr std::size_t kSlotCount = static_cast<std::size_t>(Slot::kHistory0) + kHistoryLength;

inline constexpr std::size_t kMaxPageBytes = 65536;

/// "factory", "A", "B", "history 0", ... "history 7".
const char* to_string(Slot slot);

/// Slot of the history ring that keeps a generation once it is superseded.
constexpr Slot history_slot(std::size_t number) {
  return static_cast<Slot>(static_cast<std::size_t>(Slot::kHistory0) + number % kHistoryLength);
}

/// Eleven slots of one size. It follows from the size of the medium alone, so a firmware update finds what its
/// predecessor wrote: the rule in plan() is part of the format.
struct Layout {
  std::size_t slot_bytes = 0;
  std::size_t page_bytes = 0;

  /// @return kInvalidArgument for a page that is not a power of two up to 65536; kCapacity for a medium of less than
  ///         eleven slots of 1 KiB, or whose pages are larger than a slot.
  static Result<Layout> plan(std::size_t medium_bytes, std::size_t page_bytes);
  static Result<Layout> plan(const ports::Medium& medium) { return plan(medium.size_bytes(), medium.page_bytes()); }

  std::size_t offset(Slot slot) const { return static_cast<std::size_t>(slot) * slot_bytes; }
};

}  // namespace roomcal::store
