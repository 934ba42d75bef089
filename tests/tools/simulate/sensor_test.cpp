#include "tools/simulate/sensor.h"

#include <cmath>

#include <gtest/gtest.h>

namespace roomcal::tools {
namespace {

RadianceImage even(float value) { return {200, 200, std::vector<float>(200 * 200, value)}; }

TEST(ImageSensor, Noise_HasTheAskedSigmaAtMidGrey) {
  const ImageSensor sensor{.noise_sigma = 3, .seed = 5};
  const cv::Mat image = digitize(even(128.3F), sensor);
  double sum = 0, squares = 0;
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 200; ++x) {
      const double error = image.at<uint8_t>(y, x) - 128.3;
      sum += error;
      squares += error * error;
    }
  }
  EXPECT_NEAR(sum / 40000, 0, 0.06);
  EXPECT_NEAR(std::sqrt(squares / 40000), std::sqrt(9 + 1.0 / 12), 0.05);
}

TEST(ImageSensor, NoNoise_Rounds) {
  const ImageSensor sensor{.noise_sigma = 0};
  EXPECT_EQ(digitize(even(99.6F), sensor).at<uint8_t>(3, 4), 100);
  EXPECT_EQ(digitize(even(300), sensor).at<uint8_t>(3, 4), 255);
  EXPECT_EQ(digitize(even(-5), sensor).at<uint8_t>(3, 4), 0);
}

TEST(ImageSensor, Vignetting_DarkensTheCorner) {
  const ImageSensor sensor{.grey_per_radiance = 100, .black_level = 0, .vignetting = 0.2};
  const RadianceImage grey = expose(even(1), sensor);
  EXPECT_NEAR(grey.at(0, 0), 80, 1e-3);
  EXPECT_NEAR(grey.at(100, 100), 100, 0.01);
}

TEST(ImageSensor, SameSeed_SameNoise) {
  const ImageSensor a{.seed = 1}, b{.seed = 2};
  EXPECT_EQ(cv::norm(digitize(even(99), a), digitize(even(99), a), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(digitize(even(99), a), digitize(even(99), b), cv::NORM_INF), 0);
}

}  // namespace
}  // namespace roomcal::tools
