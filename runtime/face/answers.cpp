#include "runtime/face/answers.h"

namespace roomcal::face {

using console::Reply;
using console::VerbId;

Status Answers::run(VerbId verb, Arguments arguments, Reply& reply) {
  switch (verb) {
    case VerbId::kVersion:
      return version(reply);
    case VerbId::kStatus:
      return status(reply);
    case VerbId::kHealth:
      return health(reply);
    case VerbId::kSensors:
      return sensors(reply);
    case VerbId::kGrab:
      return started(desk_.look(arguments.empty() ? std::string_view() : arguments[0].view()), "grab", reply);
    case VerbId::kMap:
      return map(arguments, reply);
    case VerbId::kVerify:
      return started(desk_.start(press::Kind::kVerify), "verify", reply);
    case VerbId::kCalibrate:
      return calibrate(arguments, reply);
    case VerbId::kResult:
      return result(reply);
    case VerbId::kHistory:
      return history(reply);
    case VerbId::kDiff:
      return diff(arguments, reply);
    case VerbId::kUndo:
      return undo(reply);
    case VerbId::kRestoreFactory:
      return restore_factory(reply);
    case VerbId::kExport:
      return export_record(arguments, reply);
    case VerbId::kSelftest:
      return selftest(arguments, reply);
    case VerbId::kMem:
      return mem(reply);
    case VerbId::kClock:
      return clock(reply);
    case VerbId::kLog:
      return log(arguments, reply);
    case VerbId::kReboot:
      return reboot(reply);
    case VerbId::kHelp:  // the console's own
    case VerbId::kCount:
      break;
  }
  return {StatusCode::kUnsupported, "this device does not know the verb"};
}

Status Answers::store_is_free() const {
  if (known_.store == nullptr) return {StatusCode::kUnavailable, "the store could not be opened: see `health`"};
  if (known_.press != nullptr && known_.press->now().state != press::State::kIdle)
    return {StatusCode::kUnavailable, "a press runs: wait for its result, or `calibrate abort`"};
  return ok_status();
}

Status Answers::tell_in_force(Reply& reply) {
  reply.text("store", to_string(known_.store->state()));
  if (const store::Record* record = known_.store->current()) {
    reply.integer("generation", static_cast<int64_t>(record->generation));
    reply.integer("content_generation", static_cast<int64_t>(record->content_generation));
    reply.text("verdict", to_string(record->verdict));
    reply.integer("measured_unix_s", record->measured_unix_s);
  }
  return ok_status();
}

}  // namespace roomcal::face
