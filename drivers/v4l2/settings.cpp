#include "drivers/v4l2/settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <linux/videodev2.h>

#include "drivers/v4l2/caps.h"
#include "runtime/base/text_writer.h"

namespace roomcal::drivers {

using ports::ImageFault;

namespace {

constexpr int32_t kExposureStepUs = 100;  // V4L2_CID_EXPOSURE_ABSOLUTE counts in these
constexpr int kMaxControls = 512;         // a driver whose list does not end is not followed for ever

// Whether a control's name, written as v4l2-ctl does (small letters, other signs one underscore), is `wanted`.
bool same_name(std::string_view name, std::string_view wanted) {
  std::size_t at = 0;
  bool gap = false;
  for (const char c : name) {
    const bool upper = c >= 'A' && c <= 'Z', other = !upper && !(c >= 'a' && c <= 'z') && !(c >= '0' && c <= '9');
    if (other) {
      gap = at > 0;
      continue;
    }
    if (gap && (at >= wanted.size() || wanted[at++] != '_')) return false;
    gap = false;
    if (at >= wanted.size() || wanted[at++] != (upper ? static_cast<char>(c - 'A' + 'a') : c)) return false;
  }
  return at == wanted.size();
}

Trouble find_control(const V4l2Handle& handle, std::string_view name, uint32_t& id) {
  auto query = zeroed<v4l2_queryctrl>();
  for (int i = 0; i < kMaxControls; ++i) {
    query.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
    ROOMCAL_TRY_CALL(handle.call(V4l2Call::kControl, VIDIOC_QUERYCTRL, query));
    if (!same_name(field_text(query.name), name)) continue;
    id = query.id;
    return {};
  }
  return {ImageFault::kFormat, 0};
}

// One camera's settings on their way in.
struct Applying {
  const V4l2Handle& handle;
  bool multiplanar;
  const V4l2Options& options;
  SettingsGuard& guard;
  HealthLog& log;
  Timing& timing;

  // Once more after a hiccup on the bus. @return kGone, or none whatever else happened.
  Trouble set(uint32_t id, int32_t& value, bool& done) {
    Trouble trouble = guard.set_control(id, value);
    if (trouble.fault == ImageFault::kTransient) trouble = guard.set_control(id, value);
    done = trouble.none();
    return trouble.fault == ImageFault::kGone ? trouble : Trouble{};
  }

  // Tells once what the camera did instead.
  void tell(std::string_view what, int64_t wanted, int64_t got, std::string_view unit, bool done) {
    if (done && got == wanted) return;
    std::array<char, 160> line;
    TextWriter out(line);
    out.text(what).text(" ").integer(wanted).text(unit);
    if (done) {
      out.text(" became ").integer(got).text(unit);
    } else {
      out.text(" cannot be set; the camera keeps its own");
    }
    log.note_once(out.view());
  }

  Trouble rate() {
    const double fps = options.trigger == TriggerMode::kExternal ? 0 : options.fps;
    const int64_t wanted_ns = fps > 0 ? std::llround(1e9 / fps) : 0;
    timing.period_ns = wanted_ns;
    const Trouble trouble = guard.set_rate(multiplanar, fps, timing.period_ns);
    if (trouble.fault == ImageFault::kGone) return trouble;
    constexpr int64_t kHonest = 20;  // cameras round to whole lines: a twentieth off is still the rate asked for
    const bool done = trouble.none() && std::abs(timing.period_ns - wanted_ns) <= wanted_ns / kHonest;
    if (wanted_ns > 0 && !done)
      tell("time between images", wanted_ns / 1000, timing.period_ns / 1000, " us", trouble.none());
    return {};
  }

  Trouble exposure() {
    if (options.exposure_us <= 0) return {};
    const int32_t wanted = std::max((options.exposure_us + kExposureStepUs / 2) / kExposureStepUs, 1);
    int32_t manual = V4L2_EXPOSURE_MANUAL, steps = wanted;
    bool done = false;
    ROOMCAL_TRY_CALL(set(V4L2_CID_EXPOSURE_AUTO, manual, done));
    ROOMCAL_TRY_CALL(set(V4L2_CID_EXPOSURE_ABSOLUTE, steps, done));
    if (done) timing.exposure_ns = int64_t{steps} * kExposureStepUs * 1000;
    tell("exposure", int64_t{wanted} * kExposureStepUs, int64_t{steps} * kExposureStepUs, " us", done);
    return {};
  }

  Trouble gain() {
    if (options.gain < 0) return {};
    int32_t manual = 0, value = options.gain;
    bool done = false;
    ROOMCAL_TRY_CALL(set(V4L2_CID_AUTOGAIN, manual, done));
    ROOMCAL_TRY_CALL(set(V4L2_CID_GAIN, value, done));
    if (!done) {
      ROOMCAL_TRY_CALL(set(V4L2_CID_ANALOGUE_GAIN, value, done));
    }
    tell("gain", options.gain, value, "", done);
    return {};
  }

  Trouble trigger() {
    if (options.trigger_control.name.empty()) return {};
    uint32_t id = 0;
    ROOMCAL_TRY_CALL(find_control(handle, options.trigger_control.name.view(), id));
    int32_t value = options.trigger_control.value;
    bool done = false;
    ROOMCAL_TRY_CALL(set(id, value, done));
    return done && value == options.trigger_control.value ? Trouble{} : Trouble{ImageFault::kFormat, 0};
  }
};

}  // namespace

Trouble apply_settings(const V4l2Handle& handle, bool multiplanar, const V4l2Options& options, SettingsGuard& guard,
                       HealthLog& log, Timing& timing) {
  timing = {};
  Applying applying{handle, multiplanar, options, guard, log, timing};
  ROOMCAL_TRY_CALL(applying.rate());
  ROOMCAL_TRY_CALL(applying.exposure());
  ROOMCAL_TRY_CALL(applying.gain());
  return applying.trigger();
}

}  // namespace roomcal::drivers
