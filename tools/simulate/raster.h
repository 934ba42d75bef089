#pragma once

#include <array>
#include <functional>
#include <vector>

namespace roomcal::tools {

/// Samples along each side of a pixel.
inline constexpr int kSub = 4;

/// Radiance averaged over the kSub x kSub parts of one pixel, row by row.
using PixelSamples = std::array<float, kSub * kSub>;

/// Offset of a part's centre from the pixel's, px.
constexpr double sub_offset_px(int index) { return (index + 0.5) / kSub - 0.5; }

/// What a camera looks at, pixel by pixel. Called from several threads, also for pixels just outside of the image.
class Radiance {
 public:
  virtual ~Radiance() = default;
  virtual void sample(int x, int y, PixelSamples& samples) const = 0;
};

/// A picture before the sensor: radiance, row by row.
struct RadianceImage {
  int width = 0;
  int height = 0;
  std::vector<float> values;

  float& at(int x, int y) { return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + x]; }
  float at(int x, int y) const { return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + x]; }
};

/// What the lens and the exposure do to a point, beside the pixel's own square.
struct Blur {
  double psf_sigma_px = 0.6;
  double motion_px = 0;   ///< length of a uniform motion along x during the exposure, centred
  double defocus_px = 0;  ///< diameter of the disc that a point out of focus becomes
};

/// Integrates over pixel squares and blur, both continuous: the kernel acts on the parts, not on whole pixels, because
/// blurring finished pixels turns the edge profile into a staircase (7 % of the contrast at sigma 0.6 px).
/// The result does not depend on the number of threads.
RadianceImage integrate(const Radiance& radiance, int width, int height, const Blur& blur);

/// Calls work(i) for i in [0, count), on all cores. @throws what the work threw.
void parallel_for(int count, const std::function<void(int)>& work);

}  // namespace roomcal::tools
