#pragma once

#include <string_view>

#include "runtime/profile/profile.h"

namespace roomcal::profile {

/// "v4l2", "replay", ...
const char* to_string(ImageDriver driver);

/// Whether a camera of that driver can be made to expose so.
bool knows(ImageDriver driver, TriggerMode mode);

/// What a profile asks of cameras' drivers that they cannot do, beyond check_profile(): a setting of another driver, a
/// trigger that the driver lacks or that the device does not give. Where `trigger.may_run_free`, the last two pass:
/// such a camera is to run free.
/// @param[out] what  one line with camera, field and remedy; empty for kOk. @return kUnsupported.
Status check_drivers(const Profile& profile, Reason& what);

/// Whether its driver knows the camera's trigger, and a device with a trigger of that kind makes it expose.
bool obeys(const CameraProfile& camera, TriggerKind kind);
/// From now on the camera exposes by itself.
void run_free(CameraProfile& camera);

/// What makes the cameras of that device expose together, for people: "line", "action, PTP", "action", "software",
/// "CAN", "line of others", "libcamera sync", "free".
std::string_view synchronization(const Profile& profile);

}  // namespace roomcal::profile
