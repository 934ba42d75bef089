#pragma once

#include <cstdint>

#include "runtime/base/time.h"
#include "runtime/ports/image_source.h"

namespace roomcal::drivers {

/// What is believed of a stamp. The limits are no options: beyond them a stamp is wrong for any camera.
struct StampLimits {
  static constexpr int64_t kAheadNs = 1'000'000;     ///< drivers that interpolate (UVC) may be that much early
  static constexpr int64_t kOldNs = 1'000'000'000;   ///< of an image that has just come
  static constexpr int64_t kTaiNs = 37'000'000'000;  ///< TAI - UTC since 2017, IERS Bulletin C
  static constexpr int64_t kTaiSlackNs = 500'000'000;
};

/// Whether the stamps of one stream can be believed.
class StampCheck {
 public:
  /// A new stream: its first stamp has no predecessor.
  void restart() { known_ = false; }

  /// @param stamp  of an image that has just come. @param now  of the host; only compared if of the same clock: of a
  ///               camera's own clock (kDevice) only the order is checked.
  /// @return kCount if it can be believed, else the first that holds of: kStampUnknown, kStampFrozen,
  ///         kStampTai, kStampFuture, kStampOld, kStampBackwards. The next one is compared with it all the same, so a
  ///         single wrong stamp in the future costs its successor too, and no more.
  ports::ImageFault judge(const Stamp& stamp, const Stamp& now);

 private:
  Stamp last_;
  bool known_ = false;
};

/// Numbers of one stream, counted from 0 and over any wrap: what a driver starts with means nothing.
class SequenceCount {
 public:
  struct Step {
    uint32_t sequence = 0;         ///< 0 for the first image after restart(); wraps at 2^32
    uint32_t lost_before = 0;      ///< exact, up to 2^31 - 1 in a row
    bool repeated = false;         ///< the same number as before
    bool first_after_gap = false;  ///< the numbers do not continue: first after restart(), or counted backwards
  };

  void restart() { known_ = false; }

  /// @param number  as the driver says. The same as before means that it does not count: taken as the next one.
  Step next(uint32_t number);

 private:
  uint32_t last_ = 0;
  uint32_t sequence_ = 0;
  bool known_ = false;
};

}  // namespace roomcal::drivers
