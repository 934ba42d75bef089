#pragma once

#include <string>

#include "runtime/profile/wiring.h"
#include "tools/common/yaml.h"

namespace roomcal::tools {

/// How a device is wired, in its device.yaml. Everything may be left out and is then as profile/wiring.h has it.
///
/// Of a camera:
///     driver: {kind: v4l2, key: "port:usb-0000:00:14.0-1", formats: [GREY, YUYV], rate_hz: 30, exposure_us: 2000,
///     gain: 1,
///              trigger: line, trigger_name: trigger_mode, trigger_value: 1, buffers: 4, ptp: false,
///              may_reset_port: false}           # kind: replay, v4l2, libcamera, aravis; trigger: free, software,
///              line, action
///     Of kind aravis also stamp_point: unknown (or start, middle, end of the exposure), packet_size_bytes: 0,
///     packet_delay_us: -1; of libcamera sync: none (or server, client), sync_frames: 100.
/// Of a LiDAR:
///     driver: {kind: udp, port: 2368, sender: 192.168.1.201, sender_port: 0, local: "", group: "", interface: eth1,
///              sweeps: 3}                       # kind: replay, udp
/// Of the device:
///     grab: {patience_s: 10, image_wait_s: 1.5, max_spread_ms: 0, still_px: 0.1}
///     wiring:
///       trigger: {kind: line, line: trig-out, chip: /dev/gpiochip0, pulse_us: 1000}  # or none, software, can, or
///       trigger: {kind: action, address: 192.168.7.255, device_key: 0, group_key: 1, group_mask: 1, lead_us: 0}
///                                                     # may_run_free: true arms without it, and tells
///       button: {kind: evdev, path: /dev/input/by-path/platform-gpio-keys-event, code: 141}   # or line, none
///       light: {kind: led, path: /sys/class/leds/calibrate}                                   # or line, none
///       console: {path: /dev/ttyS1, baud: 115200}
///       can: {interface: can0, standstill: true}
///       servo: {node: 5, counts_per_turn: 1048576, velocity_units_per_count: 1, acceleration_units_per_count: 1,
///               homing_method: 0, half_turn_s: 10}
///       imu: {path: "/sys/bus/iio/devices/iio:device0"}
///       thermometer: {path: /sys/class/thermal/thermal_zone0/temp}    # or a hwmon's temp1_input
///       watchdog: {path: /dev/watchdog, timeout_s: 10}
///       store: {kind: file, path: /var/lib/roomcal/store, size_bytes: 196608, page_bytes: 0}  # or partition, nvmem
///       replay: /var/lib/roomcal/shots
///
/// Strict as all of device.yaml. @throws ToolError "where:line: <what>: ...".
profile::CameraWiring read_camera_wiring(const YamlText& yaml, const YAML::Node& node, const std::string& what);
profile::LidarWiring read_lidar_wiring(const YamlText& yaml, const YAML::Node& node, const std::string& what);
profile::GrabWiring read_grab(const YamlText& yaml, const YAML::Node& node);
profile::Wiring read_wiring(const YamlText& yaml, const YAML::Node& node);

/// `{kind: v4l2, key: "..."}`: only what differs from the defaults; empty if nothing does.
std::string to_text(const profile::CameraWiring& wiring);
std::string to_text(const profile::LidarWiring& wiring);
std::string to_text(const profile::GrabWiring& grab);
/// The whole section, indented, with its key; empty if nothing differs from the defaults.
std::string wiring_text(const profile::Wiring& wiring);

}  // namespace roomcal::tools
