#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "runtime/console/rights.h"

namespace roomcal::console {

/// Everything that a console understands, in the order of help.
enum class VerbId : std::size_t {
  kHelp,
  kVersion,
  kStatus,
  kHealth,
  kSensors,
  kGrab,
  kMap,
  kVerify,
  kCalibrate,
  kResult,
  kHistory,
  kDiff,
  kUndo,
  kRestoreFactory,
  kExport,
  kSelftest,
  kMem,
  kClock,
  kLog,
  kReboot,
  kCount
};
inline constexpr std::size_t kVerbCount = static_cast<std::size_t>(VerbId::kCount);
inline constexpr std::size_t kMaxArguments = 4;

struct Verb {
  VerbId id = VerbId::kHelp;
  std::string_view name;
  std::string_view arguments;  ///< for people: "FORMAT [CAMERA]"
  Rights rights = Rights::kObserve;
  std::size_t min_arguments = 0;
  std::size_t max_arguments = 0;
  std::span<const std::string_view> choices;  ///< of the first argument; empty: free text
  std::string_view summary;
};

/// The one table: help, completion, rights, both modes and the board's handlers follow it. verbs()[i].id is i.
const std::array<Verb, kVerbCount>& verbs();

/// @return nullptr unless a verb has exactly this name: no abbreviations, so that noise does not shorten its way to
/// one.
const Verb* find_verb(std::string_view name);

/// What may follow what was typed: names of verbs for the first word, choices for the second.
/// @param line  up to the cursor.
/// @param visit  called with each whole word that begins with the last word of `line`.
/// @return length of that last word.
using VisitWord = void (*)(void* context, std::string_view word);
std::size_t complete(std::string_view line, VisitWord visit, void* context);

}  // namespace roomcal::console
