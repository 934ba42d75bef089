#pragma once

#include <cstdint>

#include "drivers/image/luma.h"

namespace roomcal::drivers {

/// How the pixels of a DRM format lie, as far as luminance is concerned. By number, not by libcamera's names: versions
/// differ in which of them they have.
/// @return kCount for a format whose luminance is not read (RGB, compressed, of a vendor's own).
PixelFormat layout_of(uint32_t fourcc, uint64_t modifier);

}  // namespace roomcal::drivers
