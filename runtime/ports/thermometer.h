#pragma once

namespace roomcal::ports {

/// How warm the device is, for the record: extrinsics move with it.
class Thermometer {
 public:
  virtual ~Thermometer() = default;
  /// Degrees Celsius now; NaN where it is not known. May wait for a bus, a few milliseconds. No heap.
  virtual double read_c() = 0;
};

}  // namespace roomcal::ports
