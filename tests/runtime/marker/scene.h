#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "runtime/marker/detector.h"
#include "tests/truth/marker_patch.h"

namespace roomcal::marker {

/// A grey image of its own bytes, to paste patches into.
struct Scene {
  int width = 0, height = 0;
  std::vector<uint8_t> pixels;

  Scene(int width_px, int height_px, uint8_t level)
      : width(width_px),
        height(height_px),
        pixels(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px), level) {}

  uint8_t& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
  ImageView view() const { return {pixels.data(), width, height}; }

  /// Copies a rendered patch; what reaches over the border is cut off.
  void paste(const truth::MarkerPatch& patch, int left, int top) {
    const std::vector<uint8_t> rendered = truth::render(patch);
    for (int y = 0; y < patch.height; ++y)
      for (int x = 0; x < patch.width; ++x)
        if (left + x >= 0 && top + y >= 0 && left + x < width && top + y < height)
          at(left + x, top + y) = rendered[static_cast<std::size_t>(y * patch.width + x)];
  }
};

/// One marker in the middle of a square patch, seen at a slant.
inline truth::MarkerPatch centred_marker(double diameter_px, double slant_deg, double azimuth_rad = 0.6) {
  truth::MarkerPatch patch;
  patch.width = patch.height = static_cast<int>(1.8 * diameter_px) + 40;
  const Vec2 centre{patch.width / 2.0 + 0.3, patch.height / 2.0 - 0.2};
  patch.H_px_plane = truth::marker_homography(centre, diameter_px, deg_to_rad(slant_deg), azimuth_rad, 0.3, 900);
  patch.diameter_px = diameter_px;
  return patch;
}

}  // namespace roomcal::marker
