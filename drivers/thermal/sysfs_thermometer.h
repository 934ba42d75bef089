#pragma once

#include "drivers/os/device_path.h"
#include "drivers/os/file_kernel.h"
#include "runtime/base/status.h"
#include "runtime/ports/thermometer.h"

namespace roomcal::drivers {

/// A temperature that Linux tells in a file of its own: `temp` of a thermal zone, `temp1_input` of a hwmon device. Both
/// hold whole thousandths of a degree Celsius (Documentation/ABI/testing/sysfs-class-thermal and sysfs-class-hwmon of
/// the kernel). The file is opened for every reading, so a sensor whose driver is loaded late is found.
class SysfsThermometer final : public ports::Thermometer {
 public:
  /// @param path  "/sys/class/thermal/thermal_zone0/temp". @param kernel  outlives the thermometer.
  SysfsThermometer(const DevicePath& path, FileKernel& kernel) : path_(path), kernel_(kernel) {}

  /// @return kInvalidArgument for a path that is too long; kNotFound if there is no temperature now, with the remedy.
  Status start();
  /// NaN also for what no device survives: below -60 or above 150 degrees.
  double read_c() override;

 private:
  DevicePath path_;
  FileKernel& kernel_;
};

}  // namespace roomcal::drivers
