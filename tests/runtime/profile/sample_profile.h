#pragma once

#include <string>
#include <string_view>

#include "runtime/profile/profile.h"

namespace roomcal::profile::test {

/// A device with every field filled and every driver in use: three cameras, a VLP-16, an Ouster and a scanner on
/// its turntable over the network, a trigger, a button and a light that may be of any kind.
Profile full_profile();

/// The least that a device is: one camera, pictures from a folder.
Profile small_profile();

/// A LiDAR of a model, with made-up angles where only the unit knows them.
/// @param model  as in device.yaml: "vlp16", "os1", "tls", ...
LidarProfile lidar_of(std::string_view name, std::string_view model);

/// Every field that a profile has, as text: equal texts are equal profiles.
std::string text_of(const Profile& profile);

}  // namespace roomcal::profile::test
