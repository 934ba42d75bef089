#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/ports/medium.h"
#include "runtime/store/layout.h"
#include "runtime/store/record.h"

namespace roomcal::store {

/// What is in a slot.
enum class SlotCondition : uint8_t {
  kEmpty,        ///< never written: all ones or all zeros
  kValid,        ///< holds a record
  kReadError,    ///< the medium did not deliver
  kBadHeader,    ///< something is there that does not begin with a record: a torn write, or foreign bytes
  kBadContent,   ///< a header whose payload fails its sum or its checks: a torn write, or bit rot
  kUnsupported,  ///< a record of another format version
  kForeign,      ///< a valid record of another device: the medium was moved
};
/// "empty", "valid", "read error", "torn or damaged header", "torn or damaged content", "another version",
/// "another device's record".
const char* to_string(SlotCondition condition);
constexpr bool is_damage(SlotCondition condition) {
  return condition != SlotCondition::kEmpty && condition != SlotCondition::kValid;
}

/// Reads and writes single slots; knows nothing of generations.
class SlotAccess {
 public:
  /// Takes two slot buffers and the encoder's scratch from the arena, for as long as that lives.
  /// @return kOutOfMemory if the arena refuses; what Layout::plan() returns.
  Status open(ports::Medium& medium, Arena& arena);

  /// Reads a slot. `record` means something only for kValid.
  /// Cost: reads header and record only; the whole slot where the header is blank.
  SlotCondition read(Slot slot, Record& record);

  /// Writes the record, syncs, drops caches, reads back and compares.
  /// @return kOk only when the record is on the medium; kCorrupt if what was read back differs; kCapacity if it is
  /// larger
  ///         than a slot; else what the medium returned. On failure the slot holds anything.
  Status write_verified(Slot slot, const Record& record);

  /// Fills the slot with ones and verifies that.
  Status erase(Slot slot);

  /// Whether the slot already holds exactly this record.
  bool holds(Slot slot, const Record& record);

  const Layout& layout() const { return layout_; }

 private:
  SlotCondition read_blank(Slot slot);
  Status write_image(Slot slot, std::size_t size);
  Status compare(Slot slot, std::size_t size);

  ports::Medium* medium_ = nullptr;
  Layout layout_;
  std::span<std::byte> image_;    ///< one slot, as it is to be
  std::span<std::byte> reading_;  ///< one slot, as it is
  std::span<std::byte> scratch_;
};

}  // namespace roomcal::store
