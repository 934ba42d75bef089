#pragma once

#include "runtime/base/fixed_text.h"
#include "runtime/profile/profile.h"

/// The parts of check_profile(): each gives the first thing that cannot work, in one line that names it and the remedy;
/// empty if all of it can.
namespace roomcal::profile {

/// What a camera's driver needs.
Reason wiring_complaint(const CameraProfile& camera);
/// What a LiDAR's driver needs.
Reason wiring_complaint(const LidarProfile& lidar);
/// Drivers that would take each other's images or packets.
Reason sharing_complaint(const Profile& profile);
/// Trigger, button, light, console, bus, servo, watchdog, store.
Reason wiring_complaint(const Wiring& wiring);

/// NaN is in nothing.
constexpr bool is_within(double value, double least, double most) { return value >= least && value <= most; }

}  // namespace roomcal::profile
