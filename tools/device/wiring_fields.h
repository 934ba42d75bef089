#pragma once

#include <array>
#include <string_view>

#include "runtime/profile/wiring.h"

/// The fields of every wiring, once: reading, writing and the list of known keys walk over them alike. `f` has
/// choice(key, enum, names), text(key, FixedText), texts(key, FixedVector of FixedText), number(key, floating or whole)
/// and flag(key, bool).
namespace roomcal::tools {

inline constexpr std::array<std::string_view, 4> kImageDriverNames = {"replay", "v4l2", "libcamera", "aravis"};
inline constexpr std::array<std::string_view, 4> kTriggerModeNames = {"free", "software", "line", "action"};
inline constexpr std::array<std::string_view, 4> kStampPointNames = {"unknown", "start", "middle", "end"};
inline constexpr std::array<std::string_view, 3> kSyncRoleNames = {"none", "server", "client"};
inline constexpr std::array<std::string_view, 2> kPacketDriverNames = {"replay", "udp"};
inline constexpr std::array<std::string_view, 5> kTriggerKindNames = {"none", "software", "line", "action", "can"};
inline constexpr std::array<std::string_view, 3> kButtonKindNames = {"none", "evdev", "line"};
inline constexpr std::array<std::string_view, 3> kLightKindNames = {"none", "led", "line"};
inline constexpr std::array<std::string_view, 3> kStoreKindNames = {"file", "partition", "nvmem"};

template <typename Fields>
void walk(profile::CameraWiring& w, Fields& f) {
  f.choice("kind", w.driver, kImageDriverNames);
  f.text("key", w.key);
  f.texts("formats", w.formats);
  f.number("rate_hz", w.rate_hz);
  f.number("exposure_us", w.exposure_us);
  f.number("gain", w.gain);
  f.choice("trigger", w.trigger, kTriggerModeNames);
  f.text("trigger_name", w.trigger_setting.name);
  f.text("trigger_value", w.trigger_setting.value);
  f.number("buffers", w.buffers);
  f.flag("ptp", w.ptp);
  f.flag("may_reset_port", w.may_reset_port);
  f.choice("stamp_point", w.stamp_point, kStampPointNames);
  f.number("packet_size_bytes", w.packet_size_bytes);
  f.number("packet_delay_us", w.packet_delay_us);
  f.choice("sync", w.sync, kSyncRoleNames);
  f.number("sync_frames", w.sync_frames);
}

template <typename Fields>
void walk(profile::LidarWiring& w, Fields& f) {
  f.choice("kind", w.driver, kPacketDriverNames);
  f.number("port", w.port);
  f.text("sender", w.sender);
  f.number("sender_port", w.sender_port);
  f.text("local", w.local);
  f.text("group", w.group);
  f.text("interface", w.interface);
  f.number("sweeps", w.sweeps);
}

template <typename Fields>
void walk(profile::GrabWiring& w, Fields& f) {
  f.number("patience_s", w.patience_s);
  f.number("image_wait_s", w.image_wait_s);
  f.number("max_spread_ms", w.max_spread_ms);
  f.number("still_px", w.still_px);
}

template <typename Fields>
void walk(profile::TriggerWiring& w, Fields& f) {
  f.choice("kind", w.kind, kTriggerKindNames);
  f.text("chip", w.chip);
  f.text("line", w.line);
  f.number("pulse_us", w.pulse_us);
  f.text("address", w.address);
  f.number("device_key", w.device_key);
  f.number("group_key", w.group_key);
  f.number("group_mask", w.group_mask);
  f.number("lead_us", w.lead_us);
  f.flag("may_run_free", w.may_run_free);
}

template <typename Fields>
void walk(profile::ButtonWiring& w, Fields& f) {
  f.choice("kind", w.kind, kButtonKindNames);
  f.text("path", w.path);
  f.number("code", w.code);
  f.text("line", w.line);
  f.flag("active_low", w.active_low);
  f.number("debounce_us", w.debounce_us);
}

template <typename Fields>
void walk(profile::LightWiring& w, Fields& f) {
  f.choice("kind", w.kind, kLightKindNames);
  f.text("path", w.path);
  f.text("line", w.line);
  f.flag("active_low", w.active_low);
}

template <typename Fields>
void walk(profile::ConsoleWiring& w, Fields& f) {
  f.text("path", w.path);
  f.number("baud", w.baud);
}

template <typename Fields>
void walk(profile::CanWiring& w, Fields& f) {
  f.text("interface", w.interface);
  f.flag("standstill", w.standstill);
}

template <typename Fields>
void walk(profile::ServoWiring& w, Fields& f) {
  f.number("node", w.node);
  f.number("counts_per_turn", w.counts_per_turn);
  f.number("velocity_units_per_count", w.velocity_units_per_count);
  f.number("acceleration_units_per_count", w.acceleration_units_per_count);
  f.number("homing_method", w.homing_method);
  f.number("half_turn_s", w.half_turn_s);
}

template <typename Fields>
void walk(profile::ImuWiring& w, Fields& f) {
  f.text("path", w.path);
}

template <typename Fields>
void walk(profile::ThermometerWiring& w, Fields& f) {
  f.text("path", w.path);
}

template <typename Fields>
void walk(profile::WatchdogWiring& w, Fields& f) {
  f.text("path", w.path);
  f.number("timeout_s", w.timeout_s);
}

template <typename Fields>
void walk(profile::StoreWiring& w, Fields& f) {
  f.choice("kind", w.kind, kStoreKindNames);
  f.text("path", w.path);
  f.number("size_bytes", w.size_bytes);
  f.number("page_bytes", w.page_bytes);
}

/// The sections of `wiring`. `visit` is called with each one's key and struct.
template <typename Visit>
void walk_sections(profile::Wiring& w, const Visit& visit) {
  visit("trigger", w.trigger);
  visit("button", w.button);
  visit("light", w.light);
  visit("console", w.console);
  visit("can", w.can);
  visit("servo", w.servo);
  visit("imu", w.imu);
  visit("thermometer", w.thermometer);
  visit("watchdog", w.watchdog);
  visit("store", w.store);
}

}  // namespace roomcal::tools
