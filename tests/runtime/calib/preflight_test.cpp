#include "runtime/calib/preflight.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace roomcal::calib {
namespace {

constexpr int kWidth = 64, kHeight = 48;

CameraSpec make_spec() {
  camera::Intrinsics k;
  k.width_px = kWidth;
  k.height_px = kHeight;
  k.fx_px = k.fy_px = 50;
  k.cx_px = 31.5;
  k.cy_px = 23.5;
  return {"cam2", camera::Camera::create(k).value(), {}};
}

std::string reason_for(const std::vector<uint8_t>& pixels, int width = kWidth, int height = kHeight) {
  return std::string(check_image(make_spec(), ImageView(pixels.data(), width, height)).view());
}

TEST(Preflight, PictureWithContrast_Passes) {
  std::vector<uint8_t> pixels(kWidth * kHeight);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<uint8_t>(40 + i % 160);
  EXPECT_EQ(reason_for(pixels), "");
}

TEST(Preflight, NoImage_NamesCableAndDriver) {
  EXPECT_NE(std::string(check_image(make_spec(), {}).view()).find("cam2: no image"), std::string::npos);
}

TEST(Preflight, OtherSize_NamesBothSizes) {
  const std::vector<uint8_t> pixels(32 * 24, 100);
  const std::string reason = reason_for(pixels, 32, 24);
  EXPECT_NE(reason.find("32x24"), std::string::npos) << reason;
  EXPECT_NE(reason.find("64x48"), std::string::npos) << reason;
}

TEST(Preflight, BlackWhiteAndFlat_NameTheRemedy) {
  EXPECT_NE(reason_for(std::vector<uint8_t>(kWidth * kHeight, 3)).find("light on"), std::string::npos);
  EXPECT_NE(reason_for(std::vector<uint8_t>(kWidth * kHeight, 255)).find("overexposed"), std::string::npos);
  EXPECT_NE(reason_for(std::vector<uint8_t>(kWidth * kHeight, 120)).find("contrast"), std::string::npos);
}

}  // namespace
}  // namespace roomcal::calib
