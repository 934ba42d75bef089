#pragma once

#include <cstdint>
#include <limits>

#include "runtime/calib/device.h"
#include "runtime/calib/outcome.h"
#include "runtime/store/record.h"

namespace roomcal::calib {

/// What a record says beside the outcome itself.
struct RecordContext {
  store::LongId map_id;
  uint32_t map_hash = 0;
  store::LongId firmware_id;
  store::Serial device_serial;
  int64_t measured_unix_s = 0;                                      ///< 0: the device has no clock
  double temperature_c = std::numeric_limits<double>::quiet_NaN();  ///< NaN: not measured
  store::Serial trigger;                                            ///< empty: not told
};

/// The outcome as it is stored: every sensor whose T_rig_sensor was measured, no other. Generations are the store's to
/// set.
///
/// @param outcome  of this device: its cameras in the same order.
/// @param[out] record  overwritten.
/// @return kNotFound if the reference was not located (there is then no rig frame); kInvalidArgument if outcome and
/// device
///         do not match; otherwise what store::check_record() says.
/// Cost: linear in the sensors; no heap.
Status to_record(const Outcome& outcome, const Device& device, const RecordContext& context, store::Record& record);

}  // namespace roomcal::calib
