#include "drivers/image/stamp_check.h"

#include <algorithm>
#include <utility>

namespace roomcal::drivers {

using ports::ImageFault;

namespace {

ImageFault against_the_host(int64_t ahead_ns) {
  const int64_t from_tai_ns = ahead_ns - StampLimits::kTaiNs;
  if (from_tai_ns >= -StampLimits::kTaiSlackNs && from_tai_ns <= StampLimits::kTaiSlackNs) return ImageFault::kStampTai;
  if (ahead_ns > StampLimits::kAheadNs) return ImageFault::kStampFuture;
  if (ahead_ns < -StampLimits::kOldNs) return ImageFault::kStampOld;
  return ImageFault::kCount;
}

// Stamps are what a device sends: the difference of any two has a value, with room to take 37 s from it.
int64_t saturating_difference(int64_t a, int64_t b) {
  constexpr int64_t kLow = INT64_MIN + StampLimits::kTaiNs;
  int64_t difference = 0;
  if (__builtin_sub_overflow(a, b, &difference)) return a > b ? INT64_MAX : kLow;
  return std::max(difference, kLow);
}

}  // namespace

ImageFault StampCheck::judge(const Stamp& stamp, const Stamp& now) {
  if (stamp.clock == ClockId::kUnknown) return ImageFault::kStampUnknown;
  const bool ordered = std::exchange(known_, true) && comparable(stamp, last_);
  const Stamp before = std::exchange(last_, stamp);
  if (ordered && stamp.ns == before.ns) return ImageFault::kStampFrozen;
  if (comparable(stamp, now)) {
    const ImageFault fault = against_the_host(saturating_difference(stamp.ns, now.ns));
    if (fault != ImageFault::kCount) return fault;
  }
  return ordered && stamp.ns < before.ns ? ImageFault::kStampBackwards : ImageFault::kCount;
}

SequenceCount::Step SequenceCount::next(uint32_t number) {
  const uint32_t ahead = number - last_;  // modulo 2^32
  const bool first = !std::exchange(known_, true);
  last_ = number;
  if (first) {
    sequence_ = 0;
    return {.first_after_gap = true};
  }
  constexpr uint32_t kHalf = uint32_t{1} << 31;
  const bool counted = ahead != 0 && ahead < kHalf;
  sequence_ += counted ? ahead : 1;
  return {sequence_, counted ? ahead - 1 : 0, ahead == 0, ahead >= kHalf};
}

}  // namespace roomcal::drivers
