#include "drivers/aravis/settings.h"

#include <array>
#include <cmath>
#include <string_view>

#include "drivers/aravis/pixel_formats.h"
#include "runtime/base/text_writer.h"

namespace roomcal::drivers {

namespace {

using Names = std::array<const char*, 3>;

// Names in the order of SFNC (2.x), its predecessor, and cameras that count in units of their own.
constexpr Names kExposure{"ExposureTime", "ExposureTimeAbs", "ExposureTimeRaw"};
constexpr Names kGain{"Gain", "GainAbs", "GainRaw"};
constexpr Names kRate{"AcquisitionFrameRate", "AcquisitionFrameRateAbs", "AcquisitionFrameRateHz"};
constexpr Names kRateSwitch{"AcquisitionFrameRateEnable", "AcquisitionFrameRateEnabled",
                            "AcquisitionFrameRateControlEnabled"};

const char* first_there(const Features& features, const Names& names) {
  for (const char* name : names)
    if (features.has(name)) return name;
  return nullptr;
}

class Settings {
 public:
  Settings(const AravisOptions& options, Features& features, HealthLog& log)
      : options_(options), features_(features), log_(log) {}

  LibraryResult apply() {
    if (!free_of_triggers()) return refused("cannot be freed of its old triggers", "the camera's trigger is locked");
    if (!pixel_format()) return refused("does not offer the pixel format", "the camera lacks the pixel format");
    if (!region()) return refused("does not offer the region", "the camera lacks the size or offset");
    exposure();
    gain();
    frame_rate();
    if (!trigger()) return refused("does not offer the trigger", "the camera lacks the trigger");
    if (!action_keys()) return refused("does not know action commands", "the camera has no action commands");
    set_if_there("ChunkModeActive", "false");
    ptp();
    return {};
  }

 private:
  LibraryResult refused(std::string_view what, const char* detail) {
    std::array<char, 200> line;
    TextWriter out(line);
    out.text("the camera ").text(what);
    if (!features_.error().empty()) out.text(": ").text(features_.error());
    log_.note_once(out.view());
    return {ports::ImageFault::kFormat, StatusCode::kUnsupported, detail};
  }

  void note_other(const char* name, double asked, double got) {
    if (std::abs(asked - got) <= 0.01 * std::abs(asked)) return;
    std::array<char, 120> line;
    TextWriter out(line);
    out.text(name).text(": ").fixed(asked, 3).text(" asked, the camera can ").fixed(got, 3);
    log_.note_once(out.view());
  }

  // Where a feature is missing, the camera does as if it were off.
  void set_if_there(const char* name, std::string_view value) {
    if (features_.has(name)) static_cast<void>(features_.set(name, value));
  }

  bool free_of_triggers() {
    if (!features_.has("TriggerMode")) return true;
    constexpr std::array<const char*, 8> kSelectors{"AcquisitionStart", "AcquisitionActive", "FrameBurstStart",
                                                    "FrameBurstActive", "FrameActive",       "ExposureStart",
                                                    "ExposureActive",   "LineStart"};
    for (const char* selector : kSelectors)
      if (features_.has_entry("TriggerSelector", selector) && features_.set("TriggerSelector", selector))
        set_if_there("TriggerMode", "Off");
    if (features_.has_entry("TriggerSelector", "FrameStart")) set_if_there("TriggerSelector", "FrameStart");
    return features_.set("TriggerMode", "Off");
  }

  bool pixel_format() { return features_.set("PixelFormat", options_.pixel_format.view()); }

  bool region() {
    set_if_there("OffsetX", "0");  // otherwise the old offset may forbid the new width
    set_if_there("OffsetY", "0");
    return exact("Width", options_.width_px) && exact("Height", options_.height_px) &&
           offset("OffsetX", options_.offset_x_px) && offset("OffsetY", options_.offset_y_px);
  }

  bool offset(const char* name, int value) { return features_.has(name) ? exact(name, value) : value == 0; }

  bool exact(const char* name, int value) {
    double got = value;
    return features_.set_clamped(name, got) && got == value && features_.get_number(name, -1) == value;
  }

  void exposure() {
    if (options_.auto_exposure) return set_if_there("ExposureAuto", "Continuous");
    if (options_.exposure_us <= 0) return;
    set_if_there("ExposureMode", "Timed");
    set_if_there("ExposureAuto", "Off");
    number(kExposure, options_.exposure_us);
  }

  void gain() {
    if (options_.gain < 0) return;
    set_if_there("GainAuto", "Off");
    number(kGain, options_.gain);
  }

  void frame_rate() {
    if (options_.frame_rate_hz <= 0 || options_.trigger != AravisTrigger::kContinuous) return;
    set_if_there("AcquisitionFrameRateAuto", "Off");
    if (const char* rate_switch = first_there(features_, kRateSwitch)) set_if_there(rate_switch, "true");
    number(kRate, options_.frame_rate_hz);
  }

  void number(const Names& names, double asked) {
    double got = 0;
    if (const char* name = first_there(features_, names)) {
      got = asked;
      if (!features_.set_clamped(name, got)) got = 0;
      got = features_.get_number(name, got);
    }
    note_other(names[0], asked, got);
  }

  std::string_view source() const {
    if (!options_.trigger_source.empty()) return options_.trigger_source.view();
    switch (options_.trigger) {
      case AravisTrigger::kSoftware:
        return "Software";
      case AravisTrigger::kLine:
        return "Line1";
      case AravisTrigger::kAction:
        return "Action1";
      case AravisTrigger::kContinuous:
        break;
    }
    return "";
  }

  bool trigger() {
    set_if_there("AcquisitionMode", "Continuous");
    if (options_.trigger == AravisTrigger::kContinuous) return true;
    if (!features_.set("TriggerSource", source()) || !features_.set("TriggerMode", "On")) return false;
    return options_.trigger_activation.empty() ||
           features_.set("TriggerActivation", options_.trigger_activation.view());
  }

  bool action_keys() {
    if (options_.trigger != AravisTrigger::kAction) return true;
    // The device key can be written, not read: it is set first and cannot be undone.
    std::array<char, 16> key;
    TextWriter out(key);
    out.unsigned_integer(options_.action_device_key);
    if (!features_.set_for_good("ActionDeviceKey", out.view())) return false;
    if (features_.has("ActionSelector")) features_.set("ActionSelector", action_index());
    return features_.set_number("ActionGroupKey", options_.action_group_key) &&
           features_.set_number("ActionGroupMask", options_.action_group_mask);
  }

  // "Action1" is the action with selector 1.
  std::string_view action_index() const {
    const std::string_view name = source();
    const std::size_t digits = name.find_last_not_of("0123456789") + 1;
    return digits < name.size() ? name.substr(digits) : "1";
  }

  // Only ever switched on, and only where it is off: a camera that is told anew begins to converge anew.
  void ptp() {
    if (options_.ptp != PtpMode::kEnable) return;
    const char* name = features_.has("PtpEnable") ? "PtpEnable" : "GevIEEE1588";
    const FixedText<63> now = features_.get(name);
    if (now.view() == "true" || now.view() == "1") return;
    if (features_.set_for_good(name, "true")) return;
    log_.note_once("the camera has no PTP; its stamps are of its own clock");
  }

  const AravisOptions& options_;
  Features& features_;
  HealthLog& log_;
};

}  // namespace

LibraryResult apply_settings(const AravisOptions& options, Features& features, HealthLog& log) {
  return Settings(options, features, log).apply();
}

int64_t exposure_ns(const Features& features, int64_t otherwise) {
  for (const char* name : {kExposure[0], kExposure[1]}) {
    const double exposure_us = features.get_number(name, -1);
    if (exposure_us > 0 && exposure_us < 1e9) return static_cast<int64_t>(exposure_us * 1e3);
  }
  return otherwise;
}

}  // namespace roomcal::drivers
