#pragma once

#include "runtime/base/fixed_text.h"

namespace roomcal::calib {

/// printf into a fixed text; what does not fit is cut. No allocation for the conversions that we use (%s %d %zu %.Nf).
[[gnu::format(printf, 1, 2)]] Reason make_reason(const char* format, ...);

}  // namespace roomcal::calib
