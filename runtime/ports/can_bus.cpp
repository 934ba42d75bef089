#include "runtime/ports/can_bus.h"

namespace roomcal::ports {

const char* to_string(CanState state) {
  switch (state) {
    case CanState::kDown:
      return "down";
    case CanState::kActive:
      return "active";
    case CanState::kWarning:
      return "warning";
    case CanState::kPassive:
      return "passive";
    case CanState::kBusOff:
      return "bus-off";
  }
  return "unknown";
}

}  // namespace roomcal::ports
