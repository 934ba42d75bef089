#pragma once

#include <arv.h>

#include "drivers/aravis/pixel_formats.h"
#include "drivers/relay/library_camera.h"

namespace roomcal::drivers {

/// Whether a stream hands the buffer out only because it ends.
bool is_unused(ArvBufferStatus status);

/// Slot, fault and pixels of a finished buffer; its user data is the slot. Incomplete buffers are usual, and kShort.
/// A buffer of another size or format than was set is kUndecodable.
LibraryImage image_of(ArvBuffer* buffer, const PfncFormat& format, int width_px, int height_px);

}  // namespace roomcal::drivers
