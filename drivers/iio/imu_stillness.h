#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/os/device_path.h"
#include "drivers/os/file_kernel.h"
#include "drivers/os/unique_fd.h"
#include "runtime/ports/clock.h"
#include "runtime/ports/stillness_sensor.h"

namespace roomcal::drivers {

struct ImuOptions {
  DevicePath folder = {};              ///< "/sys/bus/iio/devices/iio:device0"
  double max_rate_radps = 0.01;        ///< from the mean of the window: 0.1 mrad in the 10 ms of an exposure
  double max_acceleration_mps2 = 0.3;  ///< from the mean of the window: a person who leans on the device
  int64_t window_ns = 300'000'000;     ///< that must be quiet
  int64_t max_age_ns = 100'000'000;    ///< of the last reading
};

/// Whether the device stands still, by its IMU: gyroscope and accelerometer of an IIO device, read by sysfs.
///
/// A gyroscope's bias does not matter: what counts is how far readings stray within the window. So a turn that is
/// perfectly even is not seen; images are compared besides. Every doubt is motion: a reading that fails or is old, a
/// window that is not full yet, a value that never changes (a frozen sensor has no noise).
///
/// sample() belongs to the supervised loop: a reading of six values on I2C takes a millisecond or two. No heap after
/// start(). Source: Documentation/ABI/testing/sysfs-bus-iio of the kernel (in_anglvel_x_raw times in_anglvel_scale is
/// rad/s, in_accel_x_raw times in_accel_scale m/s^2).
class ImuStillness final : public ports::StillnessSensor {
 public:
  ImuStillness(const ImuOptions& options, FileKernel& kernel) : options_(options), kernel_(kernel) {}

  /// @return kInvalidArgument for a path that is too long; kNotFound if the device has no gyroscope or no
  ///         accelerometer there. sample() then looks for it again.
  Status start();
  /// Takes a reading where one is due, 50 times a second.
  void sample(int64_t now_ns);
  ports::Stillness look(int64_t now_ns) override;

  /// Mean acceleration of the window in the IMU's frame, m/s^2: gravity, while the device stands still.
  std::array<double, 3> mean_acceleration_mps2() const;
  uint64_t failed_readings() const { return failed_; }

 private:
  static constexpr std::size_t kAxes = 6;  ///< gyroscope x y z, accelerometer x y z
  static constexpr std::size_t kReadings = 64;
  struct Reading {
    int64_t at_ns = 0;
    std::array<double, kAxes> value{};
  };

  bool read_number(const char* file, double& value) const;
  bool read_scale(std::string_view kind, double& scale) const;
  bool take(Reading& reading) const;
  std::size_t in_window(int64_t now_ns) const;
  const Reading& back(std::size_t i) const { return readings_[(next_ + kReadings - 1 - i) % kReadings]; }
  double spread(std::size_t axis, std::size_t count) const;

  ImuOptions options_;
  FileKernel& kernel_;
  bool found_ = false;
  double gyro_scale_ = 0, accel_scale_ = 0;
  std::array<Reading, kReadings> readings_{};
  std::size_t next_ = 0, count_ = 0;
  int64_t due_ns_ = 0;
  uint64_t failed_ = 0;
};

}  // namespace roomcal::drivers
