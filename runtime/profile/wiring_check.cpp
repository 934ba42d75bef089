#include "runtime/profile/wiring_check.h"

#include <bit>
#include <cmath>

#include "runtime/base/names.h"
#include "runtime/base/reason.h"
#include "runtime/grab/sweep_tray.h"
#include "runtime/profile/ipv4.h"
#include "runtime/store/layout.h"

namespace roomcal::profile {

namespace {

constexpr std::size_t kMaxInterface = 15;  // IFNAMSIZ, its end left out
constexpr uint32_t kLastKey = 0x2ff;       // KEY_MAX of linux/input-event-codes.h
constexpr uint32_t kLongestPulse_us = 1'000'000, kLongestLead_us = 1'000'000;
constexpr uint16_t kSmallestPacket = 576, kLargestPacket = 16'260;  // what every IPv4 host takes; largest jumbo frames
constexpr uint32_t kLargestStore = 64U << 20;
constexpr uint8_t kLastNode = 126;
constexpr double kLeastUnits = 1e-9, kMostUnits = 1e9;
constexpr uint32_t kSlowestLine_baud = 9'600, kFastestLine_baud = 3'000'000;

Reason about(const SensorName& sensor, const char* what) {
  const Name who(sensor);
  return make_reason("%.*s: %s", who.length, who.text, what);
}

bool is_interface(const ShortText& text) {
  return text.view().size() <= kMaxInterface && text.view().find('/') == std::string_view::npos;
}

bool is_address_or_none(const ShortText& text) { return text.empty() || is_ipv4(text.view()); }

/// Both said, and not the same.
bool differ(const ShortText& a, const ShortText& b) { return !a.empty() && !b.empty() && a.view() != b.view(); }

/// A port without a group has one owner; a group may be shared, and its packets then tell apart by their senders only.
bool would_mix(const LidarWiring& a, const LidarWiring& b) {
  if (a.driver != PacketDriver::kUdp || b.driver != PacketDriver::kUdp || a.port != b.port) return false;
  if (a.group.view() != b.group.view()) return false;
  return a.group.empty() ? !differ(a.local, b.local) : !differ(a.sender, b.sender);
}

Reason store_complaint(const StoreWiring& w) {
  if (w.page_bytes != 0 && (!std::has_single_bit(w.page_bytes) || w.page_bytes > store::kMaxPageBytes))
    return "store: its page size is not a power of two up to 65536";
  if (w.kind != StoreKind::kFile) return {};
  if (w.size_bytes > kLargestStore) return "store: a file takes 64 MiB at the most";
  if (!store::Layout::plan(w.size_bytes, w.page_bytes == 0 ? 1 : w.page_bytes).ok())
    return "store: its file is too small; it takes 11 slots of 1 KiB or more, in whole pages";
  return {};
}

Reason trigger_complaint(const TriggerWiring& w, const CanWiring& can) {
  if (w.kind == TriggerKind::kLine && w.line.empty()) return "trigger: it has no line: give its name or number";
  if (w.kind == TriggerKind::kLine && (w.pulse_us < 1 || w.pulse_us > kLongestPulse_us))
    return "trigger: pulse_us is not between 1 and 1000000";
  if (w.kind == TriggerKind::kAction && !is_ipv4(w.address.view()))
    return "trigger: an action command needs an address such as 192.168.1.255";
  if (w.kind == TriggerKind::kAction && w.lead_us > kLongestLead_us)
    return "trigger: lead_us is not between 0 and 1000000";
  if (w.kind == TriggerKind::kCan && can.interface.empty()) return "trigger: over CAN needs wiring.can.interface";
  return {};
}

Reason face_complaint(const Wiring& w) {
  if (w.button.kind == ButtonKind::kEvdev && (w.button.path.empty() || w.button.code == 0 || w.button.code > kLastKey))
    return "button: an input device needs its path and the key's code: see evtest";
  if (w.button.kind == ButtonKind::kLine && w.button.line.empty())
    return "button: it has no line: give its name or number";
  if (w.light.kind == LightKind::kLed && w.light.path.empty())
    return "light: it has no path: give its folder below /sys/class/leds";
  if (w.light.kind == LightKind::kLine && w.light.line.empty()) return "light: it has no line: give its name or number";
  if (!w.console.path.empty() && w.console.baud != 0 &&
      !is_within(w.console.baud, kSlowestLine_baud, kFastestLine_baud))
    return "console: baud is not between 9600 and 3000000, nor 0 to leave the line as it is";
  return {};
}

Reason bus_complaint(const Wiring& w) {
  if (!is_interface(w.can.interface)) return "can: no interface has a name like that: see `ip link`";
  if (w.can.standstill && w.can.interface.empty()) return "can: standstill needs wiring.can.interface";
  if (w.servo.node != 0 && w.can.interface.empty()) return "servo: it needs wiring.can.interface";
  return {};
}

Reason servo_complaint(const ServoWiring& w) {
  if (w.node > kLastNode) return "servo: its node is not between 1 and 126; 127 is our own";
  if (!is_within(std::abs(w.counts_per_turn), 1, 1e9)) return "servo: counts_per_turn is not between 1 and 1e9";
  if (!is_within(std::abs(w.velocity_units_per_count), kLeastUnits, kMostUnits) ||
      !is_within(w.acceleration_units_per_count, kLeastUnits, kMostUnits))
    return "servo: velocity or acceleration units per count are not between 1e-9 and 1e9";
  if (!is_within(w.half_turn_s, 0.5, 600)) return "servo: half_turn_s is not between 0.5 and 600";
  return {};
}

Reason watchdog_complaint(const WatchdogWiring& w) {
  if (w.path.empty() || (w.timeout_s >= 2 && w.timeout_s <= 600)) return {};
  return "watchdog: its timeout is not between 2 and 600 s";
}

}  // namespace

Reason wiring_complaint(const CameraProfile& camera) {
  const CameraWiring& w = camera.wiring;
  if (w.driver != ImageDriver::kReplay && w.key.empty())
    return about(camera.name, "its driver has no key to find it by: see the driver's README");
  if (!is_within(w.rate_hz, 0, 1000)) return about(camera.name, "rate_hz is not between 0 and 1000");
  if (!is_within(w.exposure_us, 0, 60e6)) return about(camera.name, "exposure_us is not between 0 and 60 s");
  if (!is_within(w.gain, -1, 1e6)) return about(camera.name, "gain is not between 0 and 1e6, nor -1 for its own");
  if (w.buffers < 2 || w.buffers > 16) return about(camera.name, "buffers is not between 2 and 16");
  if (w.packet_size_bytes != 0 && (w.packet_size_bytes < kSmallestPacket || w.packet_size_bytes > kLargestPacket))
    return about(camera.name, "packet_size_bytes is not between 576 and 16260, nor 0 for the camera's own");
  if (!is_within(w.packet_delay_us, -1, 1e6))
    return about(camera.name, "packet_delay_us is not between 0 and 1e6, nor -1 for the camera's own");
  if (w.sync_frames == 0) return about(camera.name, "sync_frames is 0; the server needs some to find the beat");
  return {};
}

Reason wiring_complaint(const LidarProfile& lidar) {
  const LidarWiring& w = lidar.wiring;
  if (w.sweeps < 1 || w.sweeps > grab::kMaxTraySweeps) return about(lidar.name, "a shot joins one to 32 sweeps");
  static_assert(grab::kMaxTraySweeps == 32);
  if (w.driver == PacketDriver::kReplay) return {};
  if (w.port == 0) return about(lidar.name, "its driver has no port: give the one that the sensor sends to");
  if (!is_address_or_none(w.sender) || !is_address_or_none(w.local) || !is_address_or_none(w.group))
    return about(lidar.name, "sender, local and group are addresses such as 192.168.1.201");
  if (!is_interface(w.interface)) return about(lidar.name, "no interface has a name like that: see `ip link`");
  if (!w.group.empty() && w.interface.empty())
    return about(lidar.name, "a multicast group needs the network interface towards the sensor");
  return {};
}

Reason sharing_complaint(const Profile& profile) {
  const auto& cameras = profile.cameras;
  for (std::size_t i = 0; i < cameras.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const CameraWiring &a = cameras[i].wiring, &b = cameras[k].wiring;
      if (a.driver != ImageDriver::kReplay && a.driver == b.driver && a.key.view() == b.key.view())
        return about(cameras[i].name, "another camera has its driver's key: find each by a key of its own");
    }
  const auto& lidars = profile.lidars;
  for (std::size_t i = 0; i < lidars.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (would_mix(lidars[i].wiring, lidars[k].wiring))
        return about(lidars[i].name,
                     "another LiDAR sends to the same port: set another one in the sensor and here, or, of a group, "
                     "give both their sender");
  return {};
}

Reason wiring_complaint(const Wiring& w) {
  for (const Reason& part : {store_complaint(w.store), trigger_complaint(w.trigger, w.can), face_complaint(w),
                             bus_complaint(w), servo_complaint(w.servo), watchdog_complaint(w.watchdog)})
    if (!part.empty()) return part;
  return {};
}

}  // namespace roomcal::profile
