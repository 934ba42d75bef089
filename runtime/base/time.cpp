#include "runtime/base/time.h"

namespace roomcal {

const char* to_string(ClockId clock) {
  switch (clock) {
    case ClockId::kUnknown:
      return "unknown";
    case ClockId::kMonotonic:
      return "monotonic";
    case ClockId::kRealtime:
      return "realtime";
    case ClockId::kBoottime:
      return "boottime";
    case ClockId::kTai:
      return "tai";
    case ClockId::kDevice:
      return "device";
  }
  return "unknown";
}

}  // namespace roomcal
