#include "drivers/v4l2/settings_guard.h"

#include <cmath>

#include "drivers/v4l2/caps.h"

namespace roomcal::drivers {

using ports::ImageFault;

namespace {

constexpr int64_t kSecondNs = 1'000'000'000;

int64_t to_ns(const v4l2_fract& period) {
  return period.denominator == 0 ? 0 : period.numerator * kSecondNs / period.denominator;
}

}  // namespace

void SettingsGuard::remember(bool multiplanar) {
  forget();
  format_ = FormatCall(multiplanar);
  has_format_ = format_.get(handle_).none();
}

Trouble SettingsGuard::set_control(uint32_t id, int32_t& value) {
  auto control = zeroed<v4l2_control>();
  control.id = id;
  ROOMCAL_TRY_CALL(handle_.call(V4l2Call::kControl, VIDIOC_G_CTRL, control));
  const int32_t before = control.value;
  if (before == value) return {};
  control.value = value;
  ROOMCAL_TRY_CALL(handle_.call(V4l2Call::kControl, VIDIOC_S_CTRL, control));
  value = control.value;
  if (control_count_ < controls_.size()) controls_[control_count_++] = {id, before};
  return {};
}

Trouble SettingsGuard::set_rate(bool multiplanar, double fps, int64_t& period_ns) {
  auto rate = zeroed<v4l2_streamparm>();
  rate.type = buffer_type(multiplanar);
  ROOMCAL_TRY_CALL(handle_.call(V4l2Call::kSetRate, VIDIOC_G_PARM, rate));
  v4l2_captureparm& capture = rate.parm.capture;
  const bool settable = (capture.capability & V4L2_CAP_TIMEPERFRAME) != 0;
  Trouble trouble;
  if (fps > 0 && !settable) trouble = {ImageFault::kFormat, 0};
  if (fps > 0 && settable) {
    rate_ = rate;
    has_rate_ = true;
    // Exactly 1/30 for 30: vivid takes the next shorter time for one that is shorter by a hair.
    constexpr uint32_t kParts = 1000;
    capture.timeperframe = {kParts, static_cast<uint32_t>(std::lround(fps * kParts))};
    trouble = handle_.call(V4l2Call::kSetRate, VIDIOC_S_PARM, rate);
  }
  if (const int64_t said_ns = to_ns(capture.timeperframe); trouble.none() && said_ns > 0) period_ns = said_ns;
  return trouble;
}

void SettingsGuard::restore() {
  while (control_count_ > 0) {
    auto control = zeroed<v4l2_control>();
    control.id = controls_[--control_count_].id;
    control.value = controls_[control_count_].value;
    static_cast<void>(handle_.call(V4l2Call::kControl, VIDIOC_S_CTRL, control));
  }
  if (has_format_) static_cast<void>(format_.set(handle_));
  if (has_rate_) static_cast<void>(handle_.call(V4l2Call::kSetRate, VIDIOC_S_PARM, rate_));
  forget();
}

void SettingsGuard::forget() {
  control_count_ = 0;
  has_format_ = has_rate_ = false;
}

}  // namespace roomcal::drivers
