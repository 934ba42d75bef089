#pragma once

#include <cstdint>
#include <type_traits>

#include "runtime/base/fixed_text.h"

namespace roomcal::drivers {

enum class AravisTrigger : uint8_t {
  kContinuous,  ///< at the camera's own rate
  kSoftware,    ///< SoftwareTrigger
  kLine,        ///< an input of the camera
  kAction,      ///< ActionTrigger of drivers/gige
};

enum class PtpMode : uint8_t {
  kLeave,   ///< as the camera is
  kEnable,  ///< switched on where it is off, and left on: a clock that has converged is worth keeping
};

/// Where in the exposure the camera takes its stamp; the manual tells.
enum class StampPoint : uint8_t {
  kUnknown,  ///< anywhere in it: half the exposure of uncertainty
  kExposureStart,
  kExposureMiddle,
  kExposureEnd,
};

/// A GigE Vision or USB3 Vision camera. Plain memory: a board's binary profile fills it. What is 0, negative or empty
/// leaves the camera as it is, unless said otherwise.
struct AravisOptions {
  FixedText<63> key;  ///< its serial number, its id as arv-tool-0.8 lists it, its MAC or its IP address

  int width_px = 0;  ///< 1 at least
  int height_px = 0;
  int offset_x_px = 0;  ///< of the region on the sensor; always set
  int offset_y_px = 0;
  FixedText<31> pixel_format = "Mono8";  ///< as the camera names it, see drivers/aravis/pixel_formats.h

  double frame_rate_hz = 0;
  double exposure_us = 0;
  bool auto_exposure = false;
  double gain = -1;  ///< in the camera's unit, mostly dB

  AravisTrigger trigger = AravisTrigger::kContinuous;
  FixedText<31> trigger_source;      ///< empty: Software, Line1, Action1
  FixedText<31> trigger_activation;  ///< "RisingEdge", ...
  uint32_t action_device_key = 0;    ///< of kAction, as in ActionOptions
  uint32_t action_group_key = 0;
  uint32_t action_group_mask = 0xFFFFFFFF;

  PtpMode ptp = PtpMode::kLeave;
  StampPoint stamp_point = StampPoint::kUnknown;

  int buffers = 6;  ///< 3 to kMaxLibraryBuffers

  // GigE Vision only.
  bool no_packet_socket = false;  ///< never the kernel's packet socket; on loopback it is off in any case
  int packet_size_bytes = 0;      ///< 0: the camera's, or less where the network does not carry that
  int64_t packet_delay_ns = -1;   ///< for several cameras behind one switch
};
static_assert(std::is_trivially_copyable_v<AravisOptions>);

}  // namespace roomcal::drivers
