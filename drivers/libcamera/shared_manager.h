#pragma once

#include <memory>

#include <libcamera/libcamera.h>

namespace roomcal::drivers {

/// libcamera's manager, of which a process may have one only: made by the first camera that needs it, gone with the
/// last. It has a thread of its own and follows what is plugged in.
/// @return null if libcamera does not start.
std::shared_ptr<libcamera::CameraManager> shared_manager();

}  // namespace roomcal::drivers
