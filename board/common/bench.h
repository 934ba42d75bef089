#pragma once

#include <functional>

#include "board/common/machine.h"

namespace roomcal::board {

/// Measures a machine that is armed, on the device itself: verifies again and again, as the button does, and tells how
/// long each stage took at worst and in the middle, what of the arenas and stacks was used, which pages were missing.
/// The extrinsics of the last run follow, with enough digits to compare processors.
///
/// Writes nothing to the store.
///
/// @param runs  how often, 1 or more.
/// @param meanwhile  called again and again while a run goes on: waits a little, serves what the run listens to.
/// @return 0; 1 if a run ended without extrinsics, with its reason.
int run_bench(Machine& machine, int runs, const std::function<void()>& meanwhile);

}  // namespace roomcal::board
