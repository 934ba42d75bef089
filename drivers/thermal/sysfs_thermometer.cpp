#include "drivers/thermal/sysfs_thermometer.h"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include <fcntl.h>

#include "drivers/os/c_text.h"
#include "drivers/os/unique_fd.h"

namespace roomcal::drivers {

namespace {

constexpr double kColdest_c = -60, kWarmest_c = 150;

}  // namespace

Status SysfsThermometer::start() {
  ROOMCAL_TRY(check_path(path_));
  if (std::isfinite(read_c())) return ok_status();
  return {StatusCode::kNotFound,
          "there is no temperature in wiring.thermometer's file: load its driver, or choose another of "
          "/sys/class/thermal/thermal_zone*/temp and /sys/class/hwmon/hwmon*/temp*_input"};
}

double SysfsThermometer::read_c() {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const UniqueFd fd(kernel_.open(CText(path_).c_str(), O_RDONLY));
  std::array<char, 32> text{};
  const long size = fd.valid() ? kernel_.read(fd.get(), std::as_writable_bytes(std::span(text))) : -1;
  if (size <= 0) return kUnknown;
  long thousandths = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + size, thousandths);
  if (error != std::errc() || (end != text.data() + size && *end != '\n')) return kUnknown;
  const double degrees_c = 1e-3 * static_cast<double>(thousandths);
  return degrees_c >= kColdest_c && degrees_c <= kWarmest_c ? degrees_c : kUnknown;
}

}  // namespace roomcal::drivers
