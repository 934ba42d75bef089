#include "drivers/aravis/stamping.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace roomcal::drivers {

namespace {

constexpr int64_t kLongestWayNs = 10'000'000'000;
constexpr int64_t kTaiNs = 37'000'000'000;  // TAI - UTC since 2017, IERS Bulletin C
constexpr int64_t kSameClockNs = 1'000'000'000;
constexpr int64_t kTickNs = 1'000;  // cameras count 8 ns to 1 us
constexpr uint64_t kSixteenBits = 65'535;

// The host's real time of arrival on its monotonic clock; a clock that was set in between must not bring it too far.
int64_t arrival_ns(int64_t host_ns, const ports::SystemClocks& clocks) {
  const int64_t ago_ns = clocks.read(ClockId::kRealtime).ns - host_ns;
  return clocks.now_ns() - std::clamp<int64_t>(ago_ns, 0, kLongestWayNs);
}

ClockId clock_of(const AravisStamps& stamps, PtpState ptp) {
  if (!is_locked(ptp)) return ClockId::kDevice;
  const int64_t ahead_ns = stamps.camera_ns - stamps.host_ns;
  if (std::abs(ahead_ns) < kSameClockNs) return ClockId::kRealtime;
  if (std::abs(ahead_ns - kTaiNs) < kSameClockNs) return ClockId::kTai;
  return ClockId::kDevice;
}

}  // namespace

ImageStamp stamp_of(const AravisStamps& stamps, const StampContext& context, const ports::SystemClocks& clocks) {
  const int64_t arrived_ns = arrival_ns(stamps.host_ns, clocks);
  if (!context.ticks_known || stamps.camera_ns == 0)
    return {{arrived_ns - context.exposure_ns - kReadoutNs / 2, ClockId::kMonotonic}, kReadoutNs / 2, arrived_ns};
  const ClockId clock = clock_of(stamps, context.ptp);
  switch (context.point) {
    case StampPoint::kExposureStart:
      return {{stamps.camera_ns, clock}, kTickNs, arrived_ns};
    case StampPoint::kExposureMiddle:
      return {{stamps.camera_ns - context.exposure_ns / 2, clock}, kTickNs, arrived_ns};
    case StampPoint::kExposureEnd:
      return {{stamps.camera_ns - context.exposure_ns, clock}, kTickNs, arrived_ns};
    case StampPoint::kUnknown:
      break;
  }
  return {{stamps.camera_ns - context.exposure_ns / 2, clock}, context.exposure_ns / 2 + kTickNs, arrived_ns};
}

uint32_t BlockNumbers::next(uint64_t block_id) {
  const uint64_t before = std::exchange(last_, block_id);
  uint64_t step = block_id - before;  // modulo 2^64: backwards, where it is that
  const uint64_t wrapped = block_id + kSixteenBits - before;
  if (block_id < before && before <= kSixteenBits && wrapped < kSixteenBits / 2) step = wrapped;
  count_ += static_cast<uint32_t>(step);
  return count_;
}

}  // namespace roomcal::drivers
