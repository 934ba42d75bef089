#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "runtime/base/fixed_text.h"
#include "runtime/base/fixed_vector.h"
#include "runtime/base/time.h"
#include "runtime/calib/device.h"
#include "runtime/lidar/sweep_builder.h"
#include "runtime/ports/can_bus.h"
#include "runtime/ports/image_source.h"
#include "runtime/ports/packet_source.h"
#include "runtime/ports/stillness_sensor.h"

/// How the parts of a device are, at one moment: what `status`, `health`, `sensors`, `mem` and `clock` tell.
namespace roomcal::face {

struct CameraVitals {
  SensorName name;
  std::string_view driver;  ///< "v4l2"
  FixedText<127> key;
  int width_px = 0, height_px = 0;
  ports::ImageHealth health;
  double rate_hz = 0;         ///< of the last seconds
  int64_t last_image_ns = 0;  ///< monotonic; 0: none yet
  ClockId clock = ClockId::kUnknown;
  int64_t uncertainty_ns = 0;  ///< of its stamps on the host's clock
  uint32_t clock_steps = 0;
};

struct LidarVitals {
  SensorName name;
  SensorName model;
  std::string_view driver;  ///< "udp"
  FixedText<63> address;
  bool connected = true;  ///< the network interface that it listens on is there
  ports::PacketCounters packets;
  lidar::SweepCounters sweeps;
  double sweep_rate_hz = 0;
  int64_t last_packet_ns = 0;  ///< monotonic; 0: none yet
};

struct ThreadVitals {
  FixedText<15> name;
  int64_t answered_ns = 0;  ///< monotonic, when it last said that it lives
  std::size_t stack_bytes = 0, stack_peak = 0;
  uint64_t minor_faults = 0, major_faults = 0;  ///< since arming
};
inline constexpr std::size_t kMaxThreads = calib::kMaxSensors + 3;

struct ArenaVitals {
  std::string_view name;
  std::size_t capacity = 0, used = 0, peak = 0, refusals = 0;
};
inline constexpr std::size_t kMaxArenas = 8;

struct ClockVitals {
  int64_t monotonic_ns = 0, realtime_ns = 0, boottime_ns = 0, tai_ns = 0;  ///< 0: the host has none
};

struct Vitals {
  FixedVector<CameraVitals, calib::kMaxCameras> cameras;
  FixedVector<LidarVitals, calib::kMaxLidars> lidars;
  FixedVector<ThreadVitals, kMaxThreads> threads;
  FixedVector<ArenaVitals, kMaxArenas> arenas;
  std::size_t locked_bytes = 0;  ///< the one block that everything is in
  bool locked = false;           ///< against being swapped out
  ClockVitals clocks;
  bool has_can = false;
  ports::CanState can = ports::CanState::kDown;
  ports::CanCounters can_counters;
  FixedText<31> trigger;       ///< what makes the cameras expose: "line", "free", ...
  Reason trigger_trouble;      ///< why it is not what the profile asks for; empty if it is
  Reason servo_trouble;        ///< empty where there is none, or no servo
  ports::Stillness stillness;  ///< as the sensors of motion see it; still where there are none
  bool has_stillness = false;
  int64_t now_ns = 0;      ///< monotonic
  int64_t armed_ns = 0;    ///< monotonic, when the device became ready
  bool safe_mode = false;  ///< nothing but the console: it crashed three times in a row, or could not be armed
  Reason trouble;          ///< why it could not be armed; empty if it was
};

/// What is wrong with a sensor, one line with the remedy; empty if nothing is.
Reason complaint(const CameraVitals& camera, int64_t now_ns);
Reason complaint(const LidarVitals& lidar, int64_t now_ns);

}  // namespace roomcal::face
