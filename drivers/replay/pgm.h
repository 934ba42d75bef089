#pragma once

#include <cstddef>
#include <span>

#include "runtime/base/status.h"

namespace roomcal::drivers {

/// What a binary PGM's head says; rows of `width_px` bytes follow at `pixels_at`, without padding.
struct PgmHead {
  int width_px = 0, height_px = 0;
  std::size_t pixels_at = 0;
};

/// The longest head that is read, comments included.
inline constexpr std::size_t kMaxPgmHead = 512;

/// Reads "P5 width height 255" with any white space and comments between. Source: pgm(5) of Netpbm.
/// @param bytes  the file's beginning, up to kMaxPgmHead of it.
/// @return kUnsupported for other images (text, colour, 16 bits); kCorrupt for a head that ends or makes no sense.
Result<PgmHead> read_pgm_head(std::span<const std::byte> bytes);

}  // namespace roomcal::drivers
