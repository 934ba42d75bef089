#pragma once

#include <filesystem>

#include "runtime/profile/profile.h"
#include "runtime/store/record.h"

namespace roomcal::tools {

/// The record that a device holds before it has measured: every sensor where the drawing puts it, the drawing's
/// tolerance as its covariance. Sensors without a nominal mounting are not in it: nobody knows where they are.
store::Record factory_record(const profile::Profile& profile);

/// A record that was measured with this device, as its factory record: stamped as provisioned, with the device's and
/// the sensors' serials.
/// @param file  for messages.
/// @throws ToolError naming what keeps it from being this device's: another reference, a sensor that the device does
///         not have or that has another serial, a verdict that may not be stored.
store::Record factory_record(const profile::Profile& profile, store::Record measured,
                             const std::filesystem::path& file);

}  // namespace roomcal::tools
