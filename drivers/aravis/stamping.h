#pragma once

#include <cstdint>

#include "drivers/aravis/aravis_options.h"
#include "drivers/aravis/ptp.h"
#include "runtime/base/time.h"
#include "runtime/ports/system_clocks.h"

namespace roomcal::drivers {

inline constexpr int64_t kReadoutNs = 50'000'000;  ///< and the way of the first packet, at most

/// What is known of a camera's clock when an image comes.
struct StampContext {
  bool ticks_known = false;  ///< else Aravis puts the host's clock where the camera's should be
  PtpState ptp = PtpState::kNone;
  StampPoint point = StampPoint::kUnknown;
  int64_t exposure_ns = 0;
};

struct AravisStamps {
  int64_t camera_ns = 0;  ///< arv_buffer_get_timestamp()
  int64_t host_ns = 0;    ///< arv_buffer_get_system_timestamp(): real time when the first packet came
};

struct ImageStamp {
  Stamp exposed;
  int64_t uncertainty_ns = 0;
  int64_t arrived_ns = 0;  ///< monotonic, of the first packet
};

/// When the exposure began, and by which clock, honestly. Where only an interval is known, its middle is told and the
/// uncertainty reaches its ends.
///
/// | camera | stamp | clock |
/// |---|---|---|
/// | tick rate unknown, or no stamp | arrival less exposure and half of the longest readout | monotonic |
/// | PTP locked, within a second of the host's real time / 37 s ahead of it | the camera's | realtime / tai |
/// | any other | the camera's | device |
ImageStamp stamp_of(const AravisStamps& stamps, const StampContext& context, const ports::SystemClocks& clocks);

/// The camera's numbers, which wrap, as ones that count up. GigE Vision 1.x counts 1 to 65535 and leaves 0 out; GigE
/// Vision 2 and USB3 Vision count in 64 bits.
class BlockNumbers {
 public:
  void restart() { *this = {}; }
  uint32_t next(uint64_t block_id);

 private:
  uint64_t last_ = 0;
  uint32_t count_ = 0;
};

}  // namespace roomcal::drivers
