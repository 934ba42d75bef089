#include "board/common/image_driver.h"

#include <algorithm>
#include <charconv>

namespace roomcal::board {

namespace {

constexpr double kReplayRate_hz = 10;

drivers::ReplayImageOptions replay_options(const profile::CameraProfile& camera) {
  drivers::ReplayImageOptions options;
  options.name = camera.name;
  options.width_px = camera.intrinsics.width_px;
  options.height_px = camera.intrinsics.height_px;
  const double rate_hz = camera.wiring.rate_hz > 0 ? camera.wiring.rate_hz : kReplayRate_hz;
  options.period_ns = static_cast<int64_t>(1e9 / rate_hz);
  return options;
}

/// Formats in the profile's order; without one, those that carry luminance as it is come first.
Status take_formats(const profile::CameraWiring& wiring, FixedVector<drivers::PixelFormat, 4>& formats) {
  using drivers::PixelFormat;
  for (const profile::ShortText& name : wiring.formats) {
    const PixelFormat format = drivers::pixel_format_of(name.view());
    if (format == PixelFormat::kCount)
      return {StatusCode::kUnsupported, "a pixel format that this driver does not know: see drivers/image/luma.h"};
    static_cast<void>(formats.push_back(format));
  }
  if (formats.empty())
    for (const PixelFormat format :
         {PixelFormat::kGrey8, PixelFormat::kPlanarLuma, PixelFormat::kYuyv, PixelFormat::kUyvy})
      static_cast<void>(formats.push_back(format));
  return ok_status();
}

Status v4l2_options(const profile::CameraProfile& camera, drivers::V4l2Options& options) {
  const profile::CameraWiring& w = camera.wiring;
  ROOMCAL_TRY(take_formats(w, options.formats));
  options.key = w.key;
  options.width_px = camera.intrinsics.width_px;
  options.height_px = camera.intrinsics.height_px;
  options.fps = w.rate_hz;
  options.exposure_us = static_cast<int32_t>(w.exposure_us);
  options.gain = static_cast<int32_t>(w.gain);
  options.trigger =
      w.trigger == profile::TriggerMode::kFree ? drivers::TriggerMode::kFreeRun : drivers::TriggerMode::kExternal;
  options.buffers = w.buffers;
  options.may_reset_port = w.may_reset_port;
  const std::string_view value = w.trigger_setting.value.view();
  options.trigger_control.name = w.trigger_setting.name.view();
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), options.trigger_control.value);
  if (!w.trigger_setting.name.empty() && (error != std::errc() || end != value.data() + value.size()))
    return {StatusCode::kUnsupported, "trigger_value of a V4L2 camera is the whole number that its control takes"};
  return ok_status();
}

#if ROOMCAL_ARAVIS
drivers::StampPoint to_driver(profile::StampPoint point) {
  switch (point) {
    case profile::StampPoint::kExposureStart:
      return drivers::StampPoint::kExposureStart;
    case profile::StampPoint::kExposureMiddle:
      return drivers::StampPoint::kExposureMiddle;
    case profile::StampPoint::kExposureEnd:
      return drivers::StampPoint::kExposureEnd;
    case profile::StampPoint::kUnknown:
      break;
  }
  return drivers::StampPoint::kUnknown;
}

drivers::AravisOptions aravis_options(const profile::CameraProfile& camera, const profile::TriggerWiring& trigger) {
  const profile::CameraWiring& w = camera.wiring;
  drivers::AravisOptions options;
  options.key = w.key.view();
  options.width_px = camera.intrinsics.width_px;
  options.height_px = camera.intrinsics.height_px;
  if (!w.formats.empty()) options.pixel_format = w.formats[0];
  options.frame_rate_hz = w.rate_hz;
  options.exposure_us = w.exposure_us;
  options.gain = w.gain;
  switch (w.trigger) {
    case profile::TriggerMode::kFree:
      options.trigger = drivers::AravisTrigger::kContinuous;
      break;
    case profile::TriggerMode::kSoftware:
      options.trigger = drivers::AravisTrigger::kSoftware;
      break;
    case profile::TriggerMode::kLine:
      options.trigger = drivers::AravisTrigger::kLine;
      break;
    case profile::TriggerMode::kAction:
      options.trigger = drivers::AravisTrigger::kAction;
      break;
  }
  options.trigger_source = w.trigger_setting.name;
  options.trigger_activation = w.trigger_setting.value;
  options.action_device_key = trigger.device_key;
  options.action_group_key = trigger.group_key;
  options.action_group_mask = trigger.group_mask;
  options.ptp = w.ptp ? drivers::PtpMode::kEnable : drivers::PtpMode::kLeave;
  options.stamp_point = to_driver(w.stamp_point);
  options.packet_size_bytes = w.packet_size_bytes;
  if (w.packet_delay_us >= 0) options.packet_delay_ns = static_cast<int64_t>(1e3 * w.packet_delay_us);
  options.buffers = w.buffers;
  return options;
}
#endif

#if ROOMCAL_LIBCAMERA
drivers::LibcameraSync to_driver(profile::SyncRole role) {
  switch (role) {
    case profile::SyncRole::kServer:
      return drivers::LibcameraSync::kServer;
    case profile::SyncRole::kClient:
      return drivers::LibcameraSync::kClient;
    case profile::SyncRole::kNone:
      break;
  }
  return drivers::LibcameraSync::kNone;
}

Status libcamera_options(const profile::CameraProfile& camera, drivers::LibcameraOptions& options) {
  const profile::CameraWiring& w = camera.wiring;
  ROOMCAL_TRY(take_formats(w, options.formats));
  if (w.trigger != profile::TriggerMode::kFree)
    return {StatusCode::kUnsupported, "libcamera knows no triggers: let the camera run free"};
  options.key = w.key.view();
  options.width_px = camera.intrinsics.width_px;
  options.height_px = camera.intrinsics.height_px;
  options.frame_rate_hz = w.rate_hz;
  options.exposure_us = static_cast<int32_t>(w.exposure_us);
  options.analogue_gain = static_cast<float>(std::max(w.gain, 0.0));
  options.sync = to_driver(w.sync);
  options.sync_frames = w.sync_frames;
  options.buffers = w.buffers;
  return ok_status();
}
#endif

}  // namespace

std::size_t ImageDriver::memory_bytes(const profile::CameraProfile& camera, const drivers::ReplayCursor& replay) {
  if (camera.wiring.driver != profile::ImageDriver::kReplay) return 0;
  return drivers::ReplayImageSource::memory_bytes(replay_options(camera), replay.shots());
}

Status ImageDriver::choose(const profile::CameraProfile& camera, const profile::TriggerWiring& trigger,
                           const ImageDriverParts& parts, std::span<std::byte> memory) {
  static_cast<void>(trigger);
  switch (camera.wiring.driver) {
    case profile::ImageDriver::kReplay:
      source_ = &driver_.emplace<drivers::ReplayImageSource>(replay_options(camera), parts.replay, parts.clocks,
                                                             parts.log, memory);
      return ok_status();
    case profile::ImageDriver::kV4l2: {
      drivers::V4l2Options options;
      ROOMCAL_TRY(v4l2_options(camera, options));
      source_ =
          &driver_.emplace<drivers::V4l2ImageSource>(camera.name.view(), options, parts.v4l2, parts.clocks, parts.log);
      return ok_status();
    }
    case profile::ImageDriver::kAravis:
#if ROOMCAL_ARAVIS
      relay_ = &driver_.emplace<drivers::AravisImageSource>(camera.name.view(), aravis_options(camera, trigger),
                                                            parts.clocks, parts.log);
      source_ = relay_;
      return ok_status();
#else
      return {StatusCode::kUnsupported, "this program was built without Aravis: build it with ROOMCAL_ARAVIS"};
#endif
    case profile::ImageDriver::kLibcamera:
#if ROOMCAL_LIBCAMERA
    {
      drivers::LibcameraOptions options;
      ROOMCAL_TRY(libcamera_options(camera, options));
      relay_ = &driver_.emplace<drivers::LibcameraImageSource>(camera.name.view(), options, parts.clocks, parts.log);
      source_ = relay_;
      return ok_status();
    }
#else
      return {StatusCode::kUnsupported, "this program was built without libcamera: build it with ROOMCAL_LIBCAMERA"};
#endif
  }
  return {StatusCode::kUnsupported, "an image driver that this program does not know"};
}

}  // namespace roomcal::board
