#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "runtime/base/arena.h"
#include "runtime/base/fixed_vector.h"
#include "runtime/base/status.h"
#include "runtime/ports/medium.h"
#include "runtime/store/layout.h"
#include "runtime/store/record.h"
#include "runtime/store/slot.h"

namespace roomcal::store {

/// What consumers of the extrinsics are told.
enum class State : uint8_t {
  kUncalibrated,  ///< there is no valid record anywhere; there are no extrinsics, not even identity
  kFactory,       ///< the factory record is in force
  kCalibrated,    ///< a record that this device measured is in force
};
/// "UNCALIBRATED", "FACTORY", "CALIBRATED".
const char* to_string(State state);

/// One line of the history: what a slot holds, without its sensors.
struct HistoryEntry {
  Slot slot = Slot::kFactory;
  uint64_t generation = 0;
  uint64_t content_generation = 0;
  Action action = Action::kCalibrated;
  Verdict verdict = Verdict::kFailService;
  int64_t measured_unix_s = 0;
  int64_t written_unix_s = 0;
  LongId map_id;
  bool in_force = false;
};
using History = FixedVector<HistoryEntry, kSlotCount>;

/// Calibration records on a medium that may lose power at any byte.
///
/// Three kinds of slots (layout.h): the factory record, written once; A and B, which take new records in turn, the
/// highest valid generation being in force; and a ring of the last eight superseded records. There is no pointer to the
/// record in force, so there is nothing that could be torn apart from it. load() never writes.
///
/// Not thread-safe. Holds two records and two slot buffers in the arena (plan_store_bytes()); no heap.
class Store {
 public:
  /// Takes its memory and loads.
  /// @param device_serial  records of other devices are not used (SlotCondition::kForeign); empty: not checked.
  /// @return kOutOfMemory, or what Layout::plan() refuses. Damage on the medium is not an error but a state.
  Status open(ports::Medium& medium, Arena& arena, const Serial& device_serial = {});

  /// Reads the medium again: the newest valid of A and B, else of the history, else the factory record.
  void load();

  State state() const { return state_; }
  /// The record in force; nullptr when kUncalibrated.
  const Record* current() const { return state_ == State::kUncalibrated ? nullptr : current_; }
  /// Where it was read from; meaningless when kUncalibrated.
  Slot source() const { return source_; }
  /// Of factory, A and B as of the last load or write; of the history slots as of the last list().
  const std::array<SlotCondition, kSlotCount>& conditions() const { return conditions_; }
  /// One line that names every damaged slot and what is in force; empty when all is well.
  Reason diagnosis() const;

  /// Writes a measured record: archives the one in force, writes the inactive slot, reads it back and compares. Only ok
  /// means that it is in force, and then it is so after any power cut. After any failure the old record is in force and
  /// the slot is erased, as far as the medium still lets itself be written.
  ///
  /// @param record  its generation, content_generation, previous_content, action and written_unix_s are set here.
  /// @return kInvalidArgument for a verdict that may not be written or another device's serial; kCorrupt, kCapacity,
  ///         kUnavailable as SlotAccess::write_verified().
  /// Cost: at most two records written, two read.
  Status commit(const Record& record, int64_t now_unix_s);

  /// Writes the content again that was in force before the present one; repeated, it goes further back.
  /// @return kNotFound if there was none or the history no longer holds it; else as commit().
  Status undo(int64_t now_unix_s);

  /// Writes the factory content again as the newest record. @return kNotFound if there is no factory record.
  Status restore_factory(int64_t now_unix_s);

  /// Writes the factory slot. @return kInvalidArgument if a valid factory record is there: it is written once.
  Status provision(const Record& record, int64_t now_unix_s);

  /// Every record on the medium, newest first; a generation that is both in force and archived appears once.
  /// Cost: reads all slots.
  void list(History& out);

  /// Reads the record of a generation (0: the factory's). @return kNotFound.
  Status read_generation(uint64_t generation, Record& record);

 private:
  SlotCondition read(Slot slot, Record& record);
  bool take_newest(Slot first, std::size_t count);
  bool find_content(uint64_t content_generation);
  void archive();
  void retire_other(Slot installed);
  void stamp(Action action, uint64_t content, uint64_t previous, int64_t now_unix_s);
  Status install_staged();
  Slot inactive_slot() const;

  SlotAccess slots_;
  Serial device_serial_;
  Record* current_ = nullptr;
  Record* staged_ = nullptr;
  State state_ = State::kUncalibrated;
  Slot source_ = Slot::kFactory;
  uint64_t newest_generation_ = 0;
  bool archive_failed_ = false;
  std::array<SlotCondition, kSlotCount> conditions_{};
};

/// Bytes that open() takes from its arena, an upper bound for media of this page size.
constexpr std::size_t plan_store_bytes(std::size_t page_bytes) {
  return 2 * (kMaxRecordBytes + page_bytes) + kMaxRecordBytes + 2 * sizeof(Record) + 256;
}

}  // namespace roomcal::store
