// The parts of the store that look back: list, undo, restore.

#include <algorithm>

#include "runtime/store/store.h"

namespace roomcal::store {

namespace {

HistoryEntry to_entry(Slot slot, const Record& record) {
  HistoryEntry entry;
  entry.slot = slot;
  entry.generation = record.generation;
  entry.content_generation = record.content_generation;
  entry.action = record.action;
  entry.verdict = record.verdict;
  entry.measured_unix_s = record.measured_unix_s;
  entry.written_unix_s = record.written_unix_s;
  entry.map_id = record.map_id;
  return entry;
}

bool has_generation(const History& entries, uint64_t generation) {
  return std::any_of(entries.begin(), entries.end(), [&](const HistoryEntry& e) { return e.generation == generation; });
}

}  // namespace

void Store::list(History& out) {
  out.clear();
  for (std::size_t i = 0; i < kSlotCount; ++i) {
    // A and B before the factory, so that the record in force is met before its archived twin.
    const auto slot = static_cast<Slot>((i + static_cast<std::size_t>(Slot::kA)) % kSlotCount);
    if (read(slot, *staged_) != SlotCondition::kValid || has_generation(out, staged_->generation)) continue;
    HistoryEntry entry = to_entry(slot, *staged_);
    entry.in_force = state_ != State::kUncalibrated && staged_->generation == current_->generation;
    if (!out.push_back(entry)) return;  // never: as many entries as slots
  }
  std::sort(out.begin(), out.end(),
            [](const HistoryEntry& a, const HistoryEntry& b) { return a.generation > b.generation; });
}

Status Store::read_generation(uint64_t generation, Record& record) {
  for (std::size_t i = 0; i < kSlotCount; ++i)
    if (read(static_cast<Slot>(i), record) == SlotCondition::kValid && record.generation == generation)
      return ok_status();
  return {StatusCode::kNotFound, "the store does not hold this generation; see history"};
}

bool Store::find_content(uint64_t content_generation) {
  for (std::size_t i = 0; i < kSlotCount; ++i)
    if (read(static_cast<Slot>(i), *staged_) == SlotCondition::kValid &&
        staged_->content_generation == content_generation)
      return true;
  return false;
}

Status Store::undo(int64_t now_unix_s) {
  if (state_ != State::kCalibrated || current_->previous_content == kNothingBefore)
    return {StatusCode::kNotFound, "there is nothing before the record in force"};
  if (!find_content(current_->previous_content))
    return {StatusCode::kNotFound, "the history no longer holds the record before; restore the factory's or calibrate"};
  stamp(Action::kUndone, staged_->content_generation, staged_->previous_content, now_unix_s);
  return install_staged();
}

Status Store::restore_factory(int64_t now_unix_s) {
  if (read(Slot::kFactory, *staged_) != SlotCondition::kValid)
    return {StatusCode::kNotFound, "there is no valid factory record; calibrate"};
  const uint64_t previous = state_ == State::kUncalibrated ? kNothingBefore : current_->content_generation;
  stamp(Action::kFactoryRestored, kFactoryContent, previous, now_unix_s);
  return install_staged();
}

}  // namespace roomcal::store
