#include "drivers/iio/imu_stillness.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

#include <fcntl.h>

namespace roomcal::drivers {

namespace {

constexpr int64_t kPeriod_ns = 20'000'000, kRetry_ns = 1'000'000'000;
constexpr std::array<const char*, 6> kFiles = {"in_anglvel_x_raw", "in_anglvel_y_raw", "in_anglvel_z_raw",
                                               "in_accel_x_raw",   "in_accel_y_raw",   "in_accel_z_raw"};

ports::Stillness doubt(const char* why) { return {false, why}; }

}  // namespace

bool ImuStillness::read_number(const char* file, double& value) const {
  std::array<char, 192> path{};
  const std::string_view folder = options_.folder.view();
  std::snprintf(path.data(), path.size(), "%.*s/%s", static_cast<int>(folder.size()), folder.data(), file);
  const UniqueFd fd(kernel_.open(path.data(), O_RDONLY));
  std::array<char, 32> text{};
  const long size = fd.valid() ? kernel_.read(fd.get(), std::as_writable_bytes(std::span(text))) : -1;
  if (size <= 0) return false;
  const auto [end, error] = std::from_chars(text.data(), text.data() + size, value);
  return error == std::errc() && end != text.data() && std::isfinite(value);
}

// One scale for all axes, or one each, of which the first stands for all.
bool ImuStillness::read_scale(std::string_view kind, double& scale) const {
  std::array<char, 48> file{};
  for (const char* form : {"in_%.*s_scale", "in_%.*s_x_scale"}) {
    std::snprintf(file.data(), file.size(), form, static_cast<int>(kind.size()), kind.data());
    if (read_number(file.data(), scale) && scale > 0) return true;
  }
  return false;
}

Status ImuStillness::start() {
  ROOMCAL_TRY(check_path(options_.folder));
  count_ = 0;
  found_ = read_scale("anglvel", gyro_scale_) && read_scale("accel", accel_scale_);
  return found_ ? ok_status()
                : Status(StatusCode::kNotFound, "there is no gyroscope with an accelerometer: load the IMU's driver");
}

bool ImuStillness::take(Reading& reading) const {
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    double raw = 0;
    if (!read_number(kFiles[axis], raw)) return false;
    reading.value[axis] = raw * (axis < 3 ? gyro_scale_ : accel_scale_);
  }
  return true;
}

void ImuStillness::sample(int64_t now_ns) {
  if (now_ns < due_ns_) return;
  due_ns_ = now_ns + (found_ ? kPeriod_ns : kRetry_ns);
  Reading reading{now_ns, {}};
  if (!found_ && !start().ok()) return;
  if (!take(reading)) {
    ++failed_;
    count_ = 0;  // what was quiet before is no proof any more
    found_ = false;
    return;
  }
  readings_[next_] = reading;
  next_ = (next_ + 1) % kReadings;
  count_ = std::min(count_ + 1, kReadings);
}

std::size_t ImuStillness::in_window(int64_t now_ns) const {
  std::size_t count = 0;
  while (count < count_ && back(count).at_ns >= now_ns - options_.window_ns) ++count;
  return count;
}

double ImuStillness::spread(std::size_t axis, std::size_t count) const {
  double least = back(0).value[axis], most = least;
  for (std::size_t i = 1; i < count; ++i) {
    least = std::min(least, back(i).value[axis]);
    most = std::max(most, back(i).value[axis]);
  }
  return most - least;
}

ports::Stillness ImuStillness::look(int64_t now_ns) {
  if (!found_) return doubt("imu: it cannot be read: load its driver, check its bus");
  if (count_ == 0 || now_ns - back(0).at_ns > options_.max_age_ns)
    return doubt("imu: no reading lately: check its bus");
  const std::size_t count = in_window(now_ns);
  if (count < 3 || back(count - 1).at_ns > now_ns - options_.window_ns + 2 * kPeriod_ns)
    return doubt("imu: it has not been watched for long enough yet");
  bool any_noise = false;
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    const double strays = spread(axis, count);
    any_noise = any_noise || strays > 0;
    if (axis < 3 && strays > 2 * options_.max_rate_radps) return doubt("imu: the device turns: keep it still");
    if (axis >= 3 && strays > 2 * options_.max_acceleration_mps2) return doubt("imu: the device shakes: keep it still");
  }
  if (!any_noise) return doubt("imu: its readings never change: it is frozen, restart the device");
  return {true, {}};
}

std::array<double, 3> ImuStillness::mean_acceleration_mps2() const {
  std::array<double, 3> mean{};
  const std::size_t count = count_ == 0 ? 0 : in_window(back(0).at_ns);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) mean[axis] += back(i).value[3 + axis] / static_cast<double>(count);
  return mean;
}

}  // namespace roomcal::drivers
