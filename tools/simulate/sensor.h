#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

#include "runtime/camera/camera.h"
#include "tools/simulate/raster.h"

namespace roomcal::tools {

/// From radiance to grey levels.
struct ImageSensor {
  double grey_per_radiance = 200;
  double noise_sigma = 2;   ///< grey levels at mid grey (128)
  double shot_share = 0.6;  ///< of the noise variance at mid grey that grows with the signal; the rest is read noise
  double black_level = 4;   ///< grey
  double vignetting = 0.2;  ///< loss of light at the corner of the image, falling with the square of the distance
  uint64_t seed = 0;
};

/// Noise-free grey levels, neither clipped nor rounded.
RadianceImage expose(const RadianceImage& radiance, const ImageSensor& sensor);

/// Adds the noise, rounds, clips to 0..255.
cv::Mat digitize(const RadianceImage& grey, const ImageSensor& sensor);

}  // namespace roomcal::tools
