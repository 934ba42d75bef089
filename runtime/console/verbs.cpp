#include "runtime/console/verbs.h"

namespace roomcal::console {

namespace {

using Words = std::span<const std::string_view>;

constexpr std::array<std::string_view, 1> kMapChoices{"verify"};
constexpr std::array<std::string_view, 2> kCalibrateChoices{"dry-run", "abort"};
constexpr std::array<std::string_view, 7> kFormats{"json", "kalibr", "urdf", "tf", "camera_info", "autoware", "opencv"};
constexpr std::array<std::string_view, 6> kParts{"led", "button", "sensors", "store", "map", "watchdog"};

constexpr std::array<Verb, kVerbCount> kVerbs{{
    {VerbId::kHelp, "help", "[VERB]", Rights::kObserve, 0, 1, {}, "what the console understands"},
    {VerbId::kVersion, "version", "", Rights::kObserve, 0, 0, {}, "firmware, map and device"},
    {VerbId::kStatus,
     "status",
     "",
     Rights::kObserve,
     0,
     0,
     {},
     "what the device is doing, and whether it is calibrated"},
    {VerbId::kHealth, "health", "", Rights::kObserve, 0, 0, {}, "what is wrong, sensor by sensor, with the remedy"},
    {VerbId::kSensors, "sensors", "", Rights::kObserve, 0, 0, {}, "every sensor: address, rate, losses"},
    {VerbId::kGrab, "grab", "[SENSOR]", Rights::kOperate, 0, 1, {}, "one image or sweep: brightness, rings seen"},
    {VerbId::kMap, "map", "[verify]", Rights::kObserve, 0, 1, Words(kMapChoices), "the room's map"},
    {VerbId::kVerify, "verify", "", Rights::kOperate, 0, 0, {}, "measure and compare with the store; writes nothing"},
    {VerbId::kCalibrate, "calibrate", "[dry-run|abort]", Rights::kOperate, 0, 1, Words(kCalibrateChoices),
     "measure, judge and store"},
    {VerbId::kResult, "result", "", Rights::kObserve, 0, 0, {}, "the last run: verdict, reasons, figures"},
    {VerbId::kHistory, "history", "", Rights::kObserve, 0, 0, {}, "records in the store, newest first"},
    {VerbId::kDiff,
     "diff",
     "[GENERATION [GENERATION]]",
     Rights::kObserve,
     0,
     2,
     {},
     "how far sensors moved between two records"},
    {VerbId::kUndo, "undo", "", Rights::kService, 0, 0, {}, "back to the record before"},
    {VerbId::kRestoreFactory, "restore-factory", "", Rights::kService, 0, 0, {}, "back to the factory record"},
    {VerbId::kExport, "export", "FORMAT [CAMERA]", Rights::kObserve, 1, 2, Words(kFormats),
     "the record for other software"},
    {VerbId::kSelftest, "selftest", "[PART]", Rights::kOperate, 0, 1, Words(kParts), "try the parts that can be tried"},
    {VerbId::kMem, "mem", "", Rights::kObserve, 0, 0, {}, "memory plan, peaks, refusals"},
    {VerbId::kClock, "clock", "", Rights::kObserve, 0, 0, {}, "clocks and how they relate"},
    {VerbId::kLog, "log", "[LINES]", Rights::kObserve, 0, 1, {}, "what happened"},
    {VerbId::kReboot, "reboot", "", Rights::kService, 0, 0, {}, "start again"},
}};

constexpr bool in_order() {
  for (std::size_t i = 0; i < kVerbCount; ++i)
    if (kVerbs[i].id != static_cast<VerbId>(i)) return false;
  return true;
}
static_assert(in_order(), "the table and VerbId list the same verbs in the same order");

}  // namespace

const std::array<Verb, kVerbCount>& verbs() { return kVerbs; }

const Verb* find_verb(std::string_view name) {
  for (const Verb& verb : kVerbs)
    if (verb.name == name) return &verb;
  return nullptr;
}

std::size_t complete(std::string_view line, VisitWord visit, void* context) {
  const std::size_t space = line.rfind(' ');
  const std::string_view word = space == std::string_view::npos ? line : line.substr(space + 1);
  const std::string_view before = line.substr(0, line.size() - word.size());
  const std::string_view first = before.substr(0, before.find(' '));
  const Verb* verb = find_verb(first);
  const bool is_first = before.find_first_not_of(' ') == std::string_view::npos;
  const bool is_second = verb != nullptr && before.find_first_not_of(' ', first.size()) == std::string_view::npos;
  if (is_first || (is_second && verb->id == VerbId::kHelp)) {
    for (const Verb& candidate : kVerbs)
      if (candidate.name.starts_with(word)) visit(context, candidate.name);
  } else if (is_second) {
    for (const std::string_view choice : verb->choices)
      if (choice.starts_with(word)) visit(context, choice);
  }
  return word.size();
}

}  // namespace roomcal::console
