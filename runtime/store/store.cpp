#include "runtime/store/store.h"

#include <algorithm>
#include <utility>

namespace roomcal::store {

const char* to_string(State state) {
  switch (state) {
    case State::kUncalibrated:
      return "UNCALIBRATED";
    case State::kFactory:
      return "FACTORY";
    case State::kCalibrated:
      return "CALIBRATED";
  }
  return "UNCALIBRATED";
}

Status Store::open(ports::Medium& medium, Arena& arena, const Serial& device_serial) {
  ROOMCAL_TRY(slots_.open(medium, arena));
  const std::span<Record> records = arena.allocate<Record>(2);
  if (records.empty()) return out_of_arena("the store's records");
  current_ = &records[0];
  staged_ = &records[1];
  device_serial_ = device_serial;
  load();
  return ok_status();
}

SlotCondition Store::read(Slot slot, Record& record) {
  SlotCondition condition = slots_.read(slot, record);
  const bool foreign = !device_serial_.empty() && record.device_serial.view() != device_serial_.view();
  if (condition == SlotCondition::kValid && foreign) condition = SlotCondition::kForeign;
  conditions_[static_cast<std::size_t>(slot)] = condition;
  return condition;
}

// Leaves the newest valid record of these slots in current_. Ties go to the earlier slot.
bool Store::take_newest(Slot first, std::size_t count) {
  bool found = false;
  for (std::size_t i = 0; i < count; ++i) {
    const auto slot = static_cast<Slot>(static_cast<std::size_t>(first) + i);
    if (read(slot, *staged_) != SlotCondition::kValid) continue;
    if (found && staged_->generation <= current_->generation) continue;
    std::swap(current_, staged_);
    source_ = slot;
    found = true;
  }
  return found;
}

void Store::load() {
  state_ = State::kUncalibrated;
  newest_generation_ = 0;
  archive_failed_ = false;
  conditions_.fill(SlotCondition::kEmpty);
  if (take_newest(Slot::kA, 2) || take_newest(Slot::kHistory0, kHistoryLength)) {
    state_ = State::kCalibrated;
    newest_generation_ = current_->generation;
    static_cast<void>(read(Slot::kFactory, *staged_));  // for its condition
  } else if (take_newest(Slot::kFactory, 1)) {
    state_ = State::kFactory;
  }
}

Reason Store::diagnosis() const {
  Reason text;
  for (std::size_t i = 0; i < kSlotCount; ++i) {
    if (!is_damage(conditions_[i])) continue;
    text.append(text.empty() ? "slot " : ", slot ");
    text.append(to_string(static_cast<Slot>(i)));
    text.append(": ");
    text.append(to_string(conditions_[i]));
  }
  if (archive_failed_)
    text.append(text.empty() ? "the last record could not be archived" : ", the last record could not be archived");
  if (text.empty()) return text;
  text.append("; in force: ");
  text.append(state_ == State::kUncalibrated ? to_string(state_) : to_string(source_));
  return text;
}

Slot Store::inactive_slot() const { return state_ == State::kCalibrated && source_ == Slot::kA ? Slot::kB : Slot::kA; }

// The slot that is about to be overwritten holds what was archived when it was superseded; so the history loses nothing
// to a torn write here, and a failure costs an entry of the history but not the new record.
void Store::archive() {
  if (state_ != State::kCalibrated) return;
  const Slot slot = history_slot(current_->generation);
  if (slots_.holds(slot, *current_)) return;
  archive_failed_ = !slots_.write_verified(slot, *current_).ok();
  conditions_[static_cast<std::size_t>(slot)] = archive_failed_ ? SlotCondition::kBadContent : SlotCondition::kValid;
}

// Where neither A nor B could be used, the one not written now may still come back (a read error that passes, a
// firmware that reads its version), with a generation that nobody knows. It must not outrank what is being
// acknowledged.
void Store::retire_other(Slot installed) {
  const Slot other = installed == Slot::kA ? Slot::kB : Slot::kA;
  auto& condition = conditions_[static_cast<std::size_t>(other)];
  if (is_damage(condition) && slots_.erase(other).ok()) condition = SlotCondition::kEmpty;
}

void Store::stamp(Action action, uint64_t content, uint64_t previous, int64_t now_unix_s) {
  staged_->action = action;
  staged_->generation = newest_generation_ + 1;
  staged_->content_generation = content;
  staged_->previous_content = previous;
  staged_->written_unix_s = now_unix_s;
}

Status Store::install_staged() {
  ROOMCAL_TRY(check_record(*staged_));
  archive();
  const Slot slot = inactive_slot();
  auto& condition = conditions_[static_cast<std::size_t>(slot)];
  if (const Status written = slots_.write_verified(slot, *staged_); !written.ok()) {
    // What could not be verified must not come into force by itself at the next start.
    condition = slots_.erase(slot).ok() ? SlotCondition::kEmpty : SlotCondition::kBadContent;
    return written;
  }
  condition = SlotCondition::kValid;
  retire_other(slot);
  std::swap(current_, staged_);
  state_ = State::kCalibrated;
  source_ = slot;
  newest_generation_ = current_->generation;
  return ok_status();
}

Status Store::commit(const Record& record, int64_t now_unix_s) {
  if (!may_write(record.verdict))
    return {StatusCode::kInvalidArgument, "only PASS and PASS_ADVISE may be stored; calibrate again"};
  if (!device_serial_.empty() && record.device_serial.view() != device_serial_.view())
    return {StatusCode::kInvalidArgument, "the record is of another device"};
  const uint64_t previous = state_ == State::kUncalibrated ? kNothingBefore : current_->content_generation;
  *staged_ = record;
  stamp(Action::kCalibrated, newest_generation_ + 1, previous, now_unix_s);
  return install_staged();
}

Status Store::provision(const Record& record, int64_t now_unix_s) {
  if (read(Slot::kFactory, *staged_) == SlotCondition::kValid)
    return {StatusCode::kInvalidArgument, "there is a factory record; it is written once"};
  *staged_ = record;
  staged_->generation = staged_->content_generation = kFactoryContent;
  staged_->previous_content = kNothingBefore;
  staged_->action = Action::kProvisioned;
  staged_->written_unix_s = now_unix_s;
  const Status written = slots_.write_verified(Slot::kFactory, *staged_);
  if (!written.ok()) static_cast<void>(slots_.erase(Slot::kFactory));
  load();
  return written;
}

}  // namespace roomcal::store
