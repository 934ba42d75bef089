#pragma once

#include <cstdint>

#include "runtime/base/time.h"
#include "runtime/ports/system_clocks.h"

namespace roomcal::drivers {

/// What libcamera says about one image's time.
struct SensorTimes {
  int64_t stamp_ns = 0;     ///< SensorTimestamp, else that of the buffer
  int64_t exposure_ns = 0;  ///< of this image; 0: not told
  int64_t period_ns = 0;    ///< between images; 0: not told
};

struct SensorStamp {
  Stamp exposed;
  int64_t uncertainty_ns = 0;
};

/// When the exposure began, and by which clock.
///
/// libcamera documents its stamps as CLOCK_BOOTTIME, of the first row's exposure; most pipelines hand on what the
/// kernel's driver says, which is CLOCK_MONOTONIC and the start of the readout. The clocks differ by the time that the
/// machine has slept:
///
/// | slept | stamp's age fits | clock |
/// |---|---|---|
/// | less than a millisecond | | monotonic |
/// | less than a second | both | boottime, uncertain by what it slept |
/// | more | one of them | that one |
/// | | none | unknown |
///
/// The exposure began at the stamp or one exposure before it; the middle is told.
SensorStamp sensor_stamp(const SensorTimes& times, const ports::SystemClocks& clocks);

}  // namespace roomcal::drivers
