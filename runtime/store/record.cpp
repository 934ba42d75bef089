#include "runtime/store/record.h"

namespace roomcal::store {

const char* to_string(Action action) {
  switch (action) {
    case Action::kProvisioned:
      return "provisioned";
    case Action::kCalibrated:
      return "calibrated";
    case Action::kUndone:
      return "undone";
    case Action::kFactoryRestored:
      return "factory-restored";
  }
  return "unknown";
}

const SensorRecord* Record::find(std::string_view name) const {
  for (const SensorRecord& sensor : sensors)
    if (sensor.name.view() == name) return &sensor;
  return nullptr;
}

}  // namespace roomcal::store
