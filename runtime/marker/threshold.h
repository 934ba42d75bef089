#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/span2d.h"
#include "runtime/base/status.h"

namespace roomcal::marker {

/// Side of a tile, px. A 15 px marker has rings of one pixel: larger tiles mix its rings with the sheet and the wall.
inline constexpr int kTilePx = 4;

/// One threshold per tile: a pixel is dark where it is below. 0 means the whole tile is light.
struct ThresholdMap {
  Span2D<uint8_t> tiles;   ///< ceil(width / kTilePx) x ceil(height / kTilePx)
  int quiet_contrast = 0;  ///< grey levels between darkest and lightest of 12 x 12 px where nothing is: noise

  /// Dark or light, at a pixel inside the image.
  bool dark(ImageView image, int x, int y) const { return image(x, y) < tiles(x / kTilePx, y / kTilePx); }
};

/// Where between the darkest and the lightest pixel of a neighbourhood the threshold lies.
enum class Split : uint8_t {
  kMiddle,     ///< half way: keeps the rings of small and blurred markers apart
  kGeometric,  ///< half way in ratio: a hard shadow's edge across a marker does not take the sheet in it for ink
};

/// Bytes that compute_thresholds() takes from its arena, temporary maps included.
std::size_t threshold_bytes(int width_px, int height_px);

/// Splits the darkest from the lightest pixel of the smallest neighbourhood that shows enough contrast.
///
/// Neighbourhoods are 3 x 3 tiles of 4, 8, .. 64 px: the finest resolves the rings of small markers, the coarser ones
/// fill the flat insides of wide rings. The gate is min_contrast or what noise alone shows at that brightness:
/// on a noisy wall every tile has "contrast", and the components of noise cost more time than all markers.
///
/// @param[out] map  lives as long as the arena's scope.
/// @return kOk; kOutOfMemory.
/// Cost: about 0.2 ms per megapixel.
Status compute_thresholds(ImageView image, int min_contrast, Split split, Arena& arena, ThresholdMap& map);

}  // namespace roomcal::marker
