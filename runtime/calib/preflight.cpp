#include "runtime/calib/preflight.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "runtime/base/reason.h"

namespace roomcal::calib {

namespace {

// Grey levels. Markers need 16 levels between ink and paper (marker::DetectorOptions), so an image whose brightest
// hundredth stays below 24 over black cannot hold one, nor can one whose darkest hundredth is almost white.
constexpr int kTooDark = 24;
constexpr int kTooBright = 231;
constexpr int kMinSpread = 16;

}  // namespace

Levels sample_levels(ImageView image) {
  std::array<int, 256> histogram{};
  const int step_x = std::max(1, image.width() / 100), step_y = std::max(1, image.height() / 100);
  int64_t count = 0, sum = 0;
  for (int y = step_y / 2; y < image.height(); y += step_y) {
    const uint8_t* row = image.row(y);
    for (int x = step_x / 2; x < image.width(); x += step_x) {
      ++histogram[row[x]];
      sum += row[x];
      ++count;
    }
  }
  const auto quantile = [&](int64_t rank) {
    int level = 0;
    for (int64_t seen = histogram[0]; seen <= rank && level < 255;)
      seen += histogram[static_cast<std::size_t>(++level)];
    return level;
  };
  return {quantile(count / 100), quantile(count - 1 - count / 100),
          static_cast<int>(sum / std::max<int64_t>(1, count))};
}

Reason check_image(const CameraSpec& camera, ImageView image) {
  const Name who(camera.name);
  const camera::Intrinsics& k = camera.camera.intrinsics();
  if (image.empty()) return make_reason("%.*s: no image: check its cable and driver", who.length, who.text);
  if (image.width() != k.width_px || image.height() != k.height_px)
    return make_reason(
        "%.*s: image is %dx%d but its intrinsics are for %dx%d: set the camera's mode or import its intrinsics again",
        who.length, who.text, image.width(), image.height(), k.width_px, k.height_px);
  const Levels levels = sample_levels(image);
  if (levels.high < kTooDark)
    return make_reason("%.*s: mean level %d/255: switch the room light on or open the exposure", who.length, who.text,
                       levels.mean);
  if (levels.low > kTooBright)
    return make_reason("%.*s: mean level %d/255: overexposed, shorten the exposure", who.length, who.text, levels.mean);
  if (levels.high - levels.low < kMinSpread)
    return make_reason("%.*s: image has no contrast (%d..%d): is the lens covered or out of focus?", who.length,
                       who.text, levels.low, levels.high);
  return {};
}

}  // namespace roomcal::calib
