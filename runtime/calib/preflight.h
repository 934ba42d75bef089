#pragma once

#include "runtime/base/fixed_text.h"
#include "runtime/base/span2d.h"
#include "runtime/calib/device.h"

namespace roomcal::calib {

/// Whether an image can be worth looking at, before any time is spent on it.
///
/// @return empty if it can; else one line with the camera's name and the remedy (no image, another size than the
///         intrinsics are for, too dark, too bright, no contrast).
/// Cost: some 10,000 pixels are read, whatever the size.
Reason check_image(const CameraSpec& camera, ImageView image);

}  // namespace roomcal::calib
