#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "runtime/base/fixed_vector.h"
#include "runtime/base/span2d.h"

namespace roomcal::grab {

inline constexpr int kPatchSize = 32;
inline constexpr std::size_t kMaxPatches = 24;

/// Small pieces of an image that hold enough texture to notice a hundredth of a pixel of motion; 24 kB instead of an
/// image, to compare a later one with.
struct ScenePatches {
  struct Patch {
    int x = 0, y = 0;  ///< of its first pixel
    std::array<uint8_t, kPatchSize * kPatchSize> grey{};
  };
  FixedVector<Patch, kMaxPatches> patches;
};

/// The best-textured piece of each cell of a 6 x 4 grid; cells without texture give none.
/// Cost: 1 ms, whatever the size of the image.
void take_patches(ImageView image, ScenePatches& patches);

/// How a later image of the same camera differs.
struct SceneMotion {
  std::size_t compared = 0;  ///< patches; 0: nothing can be said
  std::size_t changed = 0;   ///< of these, that no small shift explains: something else is there now
  double median_px = 0;      ///< of the shifts of the others
  double largest_px = 0;
};

/// Shift of every patch by least squares, together with its own gain and offset of the light:
///     later(x) = gain * grey(x) + offset + gradient(x) . shift
/// Source: Lucas, Kanade, IJCAI 1981, one step; shifts of more than a pixel or two show as `changed`.
/// @param later  as large as the image before; otherwise nothing is compared.
SceneMotion compare_patches(const ScenePatches& patches, ImageView later);

/// Above these a camera is taken to have moved: 0.1 px is a fifth of a millimetre at 1.2 m for a focal length of 600
/// px, less than what rings and sweeps tell; a person who walks by changes a part of the picture only.
struct MotionLimits {
  double median_px = 0.1;
  double changed_share = 0.25;
};
bool has_moved(const SceneMotion& motion, const MotionLimits& limits);

}  // namespace roomcal::grab
