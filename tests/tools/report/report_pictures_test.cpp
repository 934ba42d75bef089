#include "tools/report/report_pictures.h"

#include <string_view>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace roomcal::tools {
namespace {

std::string encoded(std::string_view text) {
  const std::vector<unsigned char> bytes(text.begin(), text.end());
  return base64(bytes.data(), bytes.size());
}

TEST(Base64, TestVectorsOfTheRfc_AreMet) {
  const std::pair<const char*, const char*> vectors[] = {{"", ""},
                                                         {"f", "Zg=="},
                                                         {"fo", "Zm8="},
                                                         {"foo", "Zm9v"},
                                                         {"foob", "Zm9vYg=="},
                                                         {"fooba", "Zm9vYmE="},
                                                         {"foobar", "Zm9vYmFy"}};
  for (const auto& [text, expected] : vectors) EXPECT_EQ(encoded(text), expected);
}

TEST(Picture, NoiseOfManyMegapixels_KeepsItsBudgetAndItsSize) {
  cv::Mat noise(3000, 4000, CV_8UC1);
  cv::RNG(7).fill(noise, cv::RNG::UNIFORM, 0, 256);
  constexpr std::size_t kBudget = 200'000;
  const nlohmann::ordered_json picture = picture_json(noise, kBudget);
  EXPECT_LT(picture.at("uri").get<std::string>().size(), kBudget * 4 / 3 + 64);
  EXPECT_EQ(picture.at("width_px"), 4000);
  EXPECT_EQ(picture.at("height_px"), 3000);
}

TEST(Picture, SmallImage_StaysAsLargeAsItIs) {
  const std::string uri = picture_json(cv::Mat(24, 32, CV_8UC1, cv::Scalar(90)), 10'000).at("uri");
  ASSERT_TRUE(uri.starts_with("data:image/jpeg;base64,/9j/"));  // a JPEG begins FF D8 FF
}

camera::Camera camera_of(const camera::Intrinsics& k) { return camera::Camera::create(k).value(); }

camera::Intrinsics lens(camera::Model model, double focal_px) {
  camera::Intrinsics k;
  k.model = model;
  k.width_px = 640;
  k.height_px = 480;
  k.fx_px = k.fy_px = focal_px;
  k.cx_px = 319.5;
  k.cy_px = 239.5;
  return k;
}

Vec3 bearing(const nlohmann::ordered_json& v) { return {v[0].get<double>(), v[1].get<double>(), v[2].get<double>()}; }

TEST(Outline, Pinhole_HasItsCornersAtEveryEighth) {
  const camera::Camera camera = camera_of(lens(camera::Model::kPinholeRadtan, 400));
  const nlohmann::ordered_json outline = outline_json(camera);
  ASSERT_EQ(outline.size(), 32U);
  const Vec2 corners_px[] = {{0, 0}, {639, 0}, {639, 479}, {0, 479}};
  for (std::size_t i = 0; i < 4; ++i) {
    Vec2 px;
    ASSERT_TRUE(camera.project(bearing(outline[8 * i]), px).ok());
    EXPECT_LT((px - corners_px[i]).norm(), 0.01);
  }
}

TEST(Outline, FisheyeBeyondItsValidField_StaysFinite) {
  for (const auto& v : outline_json(camera_of(lens(camera::Model::kKannalaBrandt, 90))))
    EXPECT_NEAR(bearing(v).norm(), 1, 1e-5);
}

}  // namespace
}  // namespace roomcal::tools
