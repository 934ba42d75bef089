#pragma once

#include "runtime/base/fixed_text.h"
#include "runtime/base/status.h"

namespace roomcal {

/// printf into a fixed text; what does not fit is cut. No allocation for the conversions that we use (%s %d %zu %.Nf).
[[gnu::format(printf, 1, 2)]] Reason make_reason(const char* format, ...);

/// A sensor's name for "%.*s".
struct Name {
  explicit Name(const SensorName& name) : length(static_cast<int>(name.view().size())), text(name.view().data()) {}
  int length;
  const char* text;
};

/// "<sensor>: <code>: <detail>", for a status that a sensor ran into.
Reason sensor_reason(const SensorName& name, const Status& status);

}  // namespace roomcal
