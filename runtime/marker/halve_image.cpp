#include "runtime/marker/halve_image.h"

#include <cstdint>
#include <span>

namespace roomcal::marker {
namespace {

void mean_row(const uint8_t* __restrict above, const uint8_t* __restrict below, int count, uint8_t* __restrict out) {
  for (int x = 0; x < count; ++x) {
    const int sum = above[2 * x] + above[2 * x + 1] + below[2 * x] + below[2 * x + 1];
    out[x] = static_cast<uint8_t>((sum + 2) >> 2);
  }
}

}  // namespace

std::size_t halved_bytes(int width_px, int height_px) {
  return static_cast<std::size_t>(width_px / 2) * static_cast<std::size_t>(height_px / 2);
}

Status halve_image(ImageView image, Arena& arena, MutableImageView& half) {
  const int width = image.width() / 2;
  const int height = image.height() / 2;
  const std::span<uint8_t> bytes = arena.allocate_uninitialized<uint8_t>(halved_bytes(image.width(), image.height()));
  if (bytes.empty()) return out_of_arena("marker candidates: give the detector detector_scratch_bytes()");
  half = MutableImageView(bytes.data(), width, height);
  for (int y = 0; y < height; ++y) mean_row(image.row(2 * y), image.row(2 * y + 1), width, half.row(y));
  return ok_status();
}

}  // namespace roomcal::marker
