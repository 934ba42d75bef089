#pragma once

#include "runtime/console/console.h"
#include "runtime/face/desk.h"

namespace roomcal::face {

/// The verbs of the console, answered: one member a verb, in the files answers_*.cpp by subject.
///
/// While a press runs its thread owns store, outcome and report: verbs that need them are refused with that reason.
/// No heap; the records that are read for diff and export live here (20 kB each).
class Answers final : public console::CommandHandler {
 public:
  Answers(Desk& desk, const Known& known) : desk_(desk), known_(known) {}

  Status run(console::VerbId verb, std::span<const console::Word> arguments, console::Reply& reply) override;

 private:
  using Arguments = std::span<const console::Word>;

  // answers_status.cpp
  Status version(console::Reply& reply);
  Status status(console::Reply& reply);
  Status health(console::Reply& reply);
  Status map(Arguments arguments, console::Reply& reply);
  Status result(console::Reply& reply);
  // answers_sensors.cpp
  Status sensors(console::Reply& reply);
  // answers_store.cpp
  Status history(console::Reply& reply);
  Status diff(Arguments arguments, console::Reply& reply);
  Status undo(console::Reply& reply);
  Status restore_factory(console::Reply& reply);
  Status export_record(Arguments arguments, console::Reply& reply);
  // answers_system.cpp
  Status calibrate(Arguments arguments, console::Reply& reply);
  Status started(Status status, std::string_view what, console::Reply& reply);
  Status selftest(Arguments arguments, console::Reply& reply);
  Status mem(console::Reply& reply);
  Status clock(console::Reply& reply);
  Status log(Arguments arguments, console::Reply& reply);
  Status reboot(console::Reply& reply);

  /// The store and the last outcome may be looked at. @return kUnavailable: a press runs, or there is no store.
  Status store_is_free() const;
  Status tell_in_force(console::Reply& reply);

  Desk& desk_;
  Known known_;
  Vitals vitals_;
  store::History history_;
  store::Record first_, second_;
  std::array<char, 32 * 1024> text_{};
};

}  // namespace roomcal::face
