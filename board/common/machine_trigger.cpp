// What makes a machine's cameras expose together.
#include "board/common/machine.h"
#include "runtime/base/reason.h"
#include "runtime/profile/driver_check.h"

namespace roomcal::board {

Status Machine::open_trigger(Reason& why) {
  const profile::TriggerWiring& w = files_.profile->wiring.trigger;
  switch (w.kind) {
    case profile::TriggerKind::kLine: {
      drivers::GpioTriggerOptions options;
      options.line.chip = w.chip.view();
      options.line.line = w.line;
      options.pulse_us = w.pulse_us;
      auto& trigger = trigger_.emplace<drivers::GpioTrigger>(options, files_kernel_, clocks_);
      if (const Status started = trigger.start(); !started.ok()) return fail(started, "trigger", why);
      sources_.trigger = &trigger;
      break;
    }
    case profile::TriggerKind::kAction: {
      drivers::ActionOptions options;
      options.address = w.address.view();
      options.device_key = w.device_key;
      options.group_key = w.group_key;
      options.group_mask = w.group_mask;
      options.lead_ns = int64_t{w.lead_us} * 1'000;
      auto& trigger = trigger_.emplace<drivers::ActionTrigger>(options, clocks_, log_);
      if (const Status opened = trigger.open(); !opened.ok()) return fail(opened, "trigger", why);
      sources_.trigger = &trigger;
      break;
    }
    case profile::TriggerKind::kCan:
      sources_.trigger = &can_.trigger();
      break;
    case profile::TriggerKind::kNone:
    case profile::TriggerKind::kSoftware:  // when there are cameras to listen to it
      break;
  }
  return ok_status();
}

// Stillness is proved by the pictures, so cameras that run free give a shot too; whoever allows it is told.
Status Machine::settle_trigger(Reason& why) {
  profile::Profile& profile = *files_.profile;
  profile::TriggerWiring& w = profile.wiring.trigger;
  const Status opened = open_trigger(why);
  if (!opened.ok()) {
    if (!w.may_run_free) return opened;
    trigger_trouble_ = make_reason("%.*s: cameras run free", static_cast<int>(why.view().size()), why.view().data());
    why.clear();
    w.kind = profile::TriggerKind::kNone;
  }
  for (profile::CameraProfile& camera : profile.cameras) {
    if (opened.ok() && profile::obeys(camera, w.kind)) continue;
    profile::run_free(camera);
    const Name who(camera.name);
    if (trigger_trouble_.empty())
      trigger_trouble_ = make_reason(
          "trigger: %.*s: neither driver nor device has the one that it should wait for: it "
          "runs free",
          who.length, who.text);
  }
  synchronization_ = profile::synchronization(profile);
  if (!trigger_trouble_.empty()) log_.note("trigger", trigger_trouble_.view());
  return ok_status();
}

Status Machine::gather_software_trigger(Reason& why) {
  if (files_.profile->wiring.trigger.kind != profile::TriggerKind::kSoftware) return ok_status();
#if ROOMCAL_ARAVIS || ROOMCAL_LIBCAMERA
  auto& trigger = trigger_.emplace<drivers::SoftwareTrigger>(clocks_);
  for (std::size_t i = 0; i < files_.profile->cameras.size(); ++i) {
    const bool listens = files_.profile->cameras[i].wiring.trigger == profile::TriggerMode::kSoftware;
    if (!listens || image_drivers_[i].relay() == nullptr) continue;
    if (const Status added = trigger.add(*image_drivers_[i].relay()); !added.ok()) return fail(added, "trigger", why);
  }
  sources_.trigger = &trigger;
  return ok_status();
#else
  return fail({StatusCode::kUnsupported, "this program has no camera driver that listens to software"}, "trigger", why);
#endif
}

}  // namespace roomcal::board
