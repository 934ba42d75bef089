#include "tools/simulate/sensor.h"

#include <algorithm>
#include <cmath>

#include "tools/simulate/random_stream.h"

namespace roomcal::tools {

RadianceImage expose(const RadianceImage& radiance, const ImageSensor& sensor) {
  RadianceImage grey = radiance;
  const double cx = (grey.width - 1) / 2.0, cy = (grey.height - 1) / 2.0;
  const double corner_px2 = cx * cx + cy * cy;
  for (int y = 0; y < grey.height; ++y) {
    for (int x = 0; x < grey.width; ++x) {
      const double r_px2 = (x - cx) * (x - cx) + (y - cy) * (y - cy);
      const double gain = sensor.grey_per_radiance * (1 - sensor.vignetting * r_px2 / corner_px2);
      grey.at(x, y) = static_cast<float>(sensor.black_level + gain * grey.at(x, y));
    }
  }
  return grey;
}

cv::Mat digitize(const RadianceImage& grey, const ImageSensor& sensor) {
  cv::Mat image(grey.height, grey.width, CV_8UC1);
  const double mid_variance = sensor.noise_sigma * sensor.noise_sigma;
  parallel_for(grey.height, [&](int y) {
    Random random = random_stream(sensor.seed, static_cast<uint64_t>(y));
    uint8_t* row = image.ptr<uint8_t>(y);
    for (int x = 0; x < grey.width; ++x) {
      const double level = grey.at(x, y);
      const double variance = mid_variance * (1 - sensor.shot_share + sensor.shot_share * std::max(0.0, level) / 128);
      const double value = level + std::sqrt(variance) * random.normal();
      row[x] = static_cast<uint8_t>(std::clamp(std::lround(value), 0L, 255L));
    }
  });
  return image;
}

}  // namespace roomcal::tools
