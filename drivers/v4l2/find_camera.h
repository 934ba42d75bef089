#pragma once

#include "drivers/v4l2/camera_key.h"
#include "drivers/v4l2/handle.h"
#include "drivers/v4l2/kernel.h"
#include "runtime/base/fixed_text.h"

namespace roomcal::drivers {

/// The only camera that a key fits.
struct FoundCamera {
  VideoNode node;
  FixedText<200> others;  ///< "video0 at pci... and video2 at ...": who else it fits, if it fits several
};

/// Looks for the camera. Opens nodes that the key may mean, to ask what they are, and closes them again.
/// @return none, and then `found.node`; kNotFound if there is none or, with `found.others`, more than one; what else
///         went wrong with a node if no other node fits.
Trouble find_camera(V4l2Kernel& kernel, const CameraKey& key, FoundCamera& found);

}  // namespace roomcal::drivers
