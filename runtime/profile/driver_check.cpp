#include "runtime/profile/driver_check.h"

#include <algorithm>
#include <array>

#include "runtime/base/reason.h"

namespace roomcal::profile {

namespace {

constexpr std::array<const char*, 4> kDrivers = {"replay", "v4l2", "libcamera", "aravis"};
constexpr std::array<const char*, 4> kModes = {"free", "software", "line", "action"};

constexpr unsigned bit(ImageDriver driver) { return 1U << static_cast<unsigned>(driver); }
constexpr unsigned kV4l2 = bit(ImageDriver::kV4l2), kAravis = bit(ImageDriver::kAravis),
                   kLibcamera = bit(ImageDriver::kLibcamera);

/// A setting that only some drivers know.
struct Special {
  const char* name;
  bool set;
  unsigned drivers;
  const char* remedy;
};

std::array<Special, 8> specials(const CameraWiring& w) {
  const CameraWiring plain;
  return {{{"ptp", w.ptp, kAravis, "leave it out; `kind: aravis` has it"},
           {"stamp_point", w.stamp_point != plain.stamp_point, kAravis, "leave it out; the driver tells it itself"},
           {"packet_size_bytes", w.packet_size_bytes != 0, kAravis, "leave it out; `kind: aravis` has it"},
           {"packet_delay_us", w.packet_delay_us >= 0, kAravis, "leave it out; `kind: aravis` has it"},
           {"sync", w.sync != plain.sync, kLibcamera, "leave it out; `kind: libcamera` has it"},
           {"sync_frames", w.sync_frames != plain.sync_frames, kLibcamera, "leave it out; `kind: libcamera` has it"},
           {"may_reset_port", w.may_reset_port, kV4l2, "leave it out; `kind: v4l2` has it"},
           {"trigger_name", !w.trigger_setting.name.empty(), kV4l2 | kAravis,
            "leave it out, with trigger_value; `kind: v4l2` and `aravis` have it"}}};
}

/// Whether the device makes such cameras expose; on a line also somebody else may, a lamp's controller for one.
bool gives(TriggerKind kind, TriggerMode mode) {
  switch (mode) {
    case TriggerMode::kFree:
      return true;
    case TriggerMode::kSoftware:
      return kind == TriggerKind::kSoftware;
    case TriggerMode::kLine:
      return kind == TriggerKind::kLine || kind == TriggerKind::kCan || kind == TriggerKind::kNone;
    case TriggerMode::kAction:
      return kind == TriggerKind::kAction;
  }
  return false;
}

Reason setting_complaint(const CameraProfile& camera) {
  const Name who(camera.name);
  for (const Special& s : specials(camera.wiring))
    if (s.set && (s.drivers & bit(camera.wiring.driver)) == 0)
      return make_reason("%.*s: driver.%s means nothing to %s: %s", who.length, who.text, s.name,
                         to_string(camera.wiring.driver), s.remedy);
  return {};
}

Reason trigger_complaint(const CameraProfile& camera, TriggerKind kind) {
  const Name who(camera.name);
  const CameraWiring& w = camera.wiring;
  const char* mode = kModes[static_cast<std::size_t>(w.trigger)];
  if (!knows(w.driver, w.trigger))
    return make_reason(
        "%.*s: driver.trigger: %s knows no `%s`: let the camera run free, use a driver that knows it, or "
        "set wiring.trigger.may_run_free",
        who.length, who.text, to_string(w.driver), mode);
  if (!gives(kind, w.trigger))
    return make_reason(
        "%.*s: driver.trigger: it waits for `%s`, and wiring.trigger.kind gives another: make both the "
        "same, or set wiring.trigger.may_run_free",
        who.length, who.text, mode);
  return {};
}

}  // namespace

const char* to_string(ImageDriver driver) { return kDrivers[static_cast<std::size_t>(driver)]; }

// As the drivers' own options have it.
bool knows(ImageDriver driver, TriggerMode mode) {
  switch (driver) {
    case ImageDriver::kAravis:
      return true;
    case ImageDriver::kV4l2:
      return mode == TriggerMode::kFree || mode == TriggerMode::kLine;
    case ImageDriver::kReplay:
    case ImageDriver::kLibcamera:
      break;
  }
  return mode == TriggerMode::kFree;
}

Status check_drivers(const Profile& profile, Reason& what) {
  what.clear();
  const TriggerWiring& trigger = profile.wiring.trigger;
  for (const CameraProfile& camera : profile.cameras) {
    what = setting_complaint(camera);
    if (what.empty() && !trigger.may_run_free) what = trigger_complaint(camera, trigger.kind);
    if (!what.empty()) return {StatusCode::kUnsupported, "a camera's driver cannot do what the profile asks for"};
  }
  return ok_status();
}

bool obeys(const CameraProfile& camera, TriggerKind kind) {
  return knows(camera.wiring.driver, camera.wiring.trigger) && gives(kind, camera.wiring.trigger);
}

void run_free(CameraProfile& camera) {
  camera.wiring.trigger = TriggerMode::kFree;
  camera.wiring.trigger_setting = {};
}

std::string_view synchronization(const Profile& profile) {
  const auto any = [&](const auto& is) { return std::any_of(profile.cameras.begin(), profile.cameras.end(), is); };
  const bool all_ptp = !any([](const CameraProfile& c) { return !c.wiring.ptp; });
  switch (profile.wiring.trigger.kind) {
    case TriggerKind::kLine:
      return "line";
    case TriggerKind::kAction:
      return all_ptp ? "action, PTP" : "action";
    case TriggerKind::kCan:
      return "CAN";
    case TriggerKind::kSoftware:
      return "software";
    case TriggerKind::kNone:
      break;
  }
  if (any([](const CameraProfile& c) { return c.wiring.trigger == TriggerMode::kLine; })) return "line of others";
  return any([](const CameraProfile& c) { return c.wiring.sync != SyncRole::kNone; }) ? "libcamera sync" : "free";
}

}  // namespace roomcal::profile
