#pragma once

#include <cstdint>
#include <span>

#include "drivers/relay/relay_source.h"
#include "runtime/base/fixed_vector.h"
#include "runtime/ports/system_clocks.h"
#include "runtime/ports/trigger.h"

namespace roomcal::drivers {

/// A command to each of several cameras, all at the same time from threads of their own: some milliseconds of spread,
/// which a device that stands still does not mind.
class SoftwareTrigger final : public ports::Trigger {
 public:
  static constexpr std::size_t kMaxCameras = 16;

  /// The sources outlive this; those that do not fit are refused by add().
  explicit SoftwareTrigger(const ports::SystemClocks& clocks) : clocks_(clocks) {}
  /// @return kCapacity.
  Status add(RelaySource& camera);

  const char* name() const override { return "software"; }
  /// @return kUnavailable if one of the cameras does not stream (then none is told), or could not be told within a
  ///         second (the others may have exposed: images of a group that stays incomplete). No heap.
  Status fire() override;

 private:
  const ports::SystemClocks& clocks_;
  FixedVector<RelaySource*, kMaxCameras> cameras_;
};

}  // namespace roomcal::drivers
