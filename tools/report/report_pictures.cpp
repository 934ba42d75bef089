#include "tools/report/report_pictures.h"

#include <algorithm>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tools/map/room_json.h"

namespace roomcal::tools {

namespace {

constexpr int kLargestSide_px = 1600;
constexpr int kSmallestSide_px = 200;
constexpr int kSideSteps = 8;  // bearings along one side of an image

cv::Mat with_largest_side(const cv::Mat& image, int side_px) {
  const double scale = static_cast<double>(side_px) / std::max(image.cols, image.rows);
  if (scale >= 1) return image;
  cv::Mat small;
  cv::resize(image, small, {}, scale, scale, cv::INTER_AREA);
  return small;
}

std::vector<unsigned char> jpeg_within(const cv::Mat& image, std::size_t budget) {
  std::vector<unsigned char> bytes;
  for (int side_px = kLargestSide_px;; side_px = side_px * 4 / 5) {
    cv::imencode(".jpg", with_largest_side(image, side_px), bytes, {cv::IMWRITE_JPEG_QUALITY, 80});
    if (bytes.size() <= budget || side_px < kSmallestSide_px) return bytes;
  }
}

/// Place on the border of an image, `step` of 4 * kSideSteps around it from its top left corner.
Vec2 on_border(const camera::Intrinsics& k, int step) {
  const double along = static_cast<double>(step % kSideSteps) / kSideSteps;
  const double right = k.width_px - 1.0, bottom = k.height_px - 1.0;
  switch (step / kSideSteps) {
    case 0:
      return {along * right, 0};
    case 1:
      return {right, along * bottom};
    case 2:
      return {(1 - along) * right, bottom};
    default:
      return {0, (1 - along) * bottom};
  }
}

/// A fisheye's corners may lie outside its valid field: the outermost pixel on the way there stands for them.
Vec3 border_bearing(const camera::Camera& camera, int step) {
  const camera::Intrinsics& k = camera.intrinsics();
  const Vec2 middle_px(k.cx_px, k.cy_px), border_px = on_border(k, step);
  Vec3 bearing_cam = Vec3::UnitZ();
  for (double share = 1; share > 0; share -= 0.02)
    if (camera.unproject(middle_px + share * (border_px - middle_px), bearing_cam).ok()) break;
  return bearing_cam;
}

}  // namespace

std::string base64(const unsigned char* bytes, std::size_t count) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((count + 2) / 3 * 4);
  for (std::size_t i = 0; i < count; i += 3) {
    const unsigned a = bytes[i], b = i + 1 < count ? bytes[i + 1] : 0U, c = i + 2 < count ? bytes[i + 2] : 0U;
    out += kDigits[a >> 2];
    out += kDigits[(a & 3U) << 4 | b >> 4];
    out += i + 1 < count ? kDigits[(b & 15U) << 2 | c >> 6] : '=';
    out += i + 2 < count ? kDigits[c & 63U] : '=';
  }
  return out;
}

nlohmann::ordered_json picture_json(const cv::Mat& grey, std::size_t budget) {
  const std::vector<unsigned char> bytes = jpeg_within(grey, budget);
  return {{"uri", "data:image/jpeg;base64," + base64(bytes.data(), bytes.size())},
          {"width_px", grey.cols},
          {"height_px", grey.rows}};
}

nlohmann::ordered_json outline_json(const camera::Camera& camera) {
  nlohmann::ordered_json outline = nlohmann::ordered_json::array();
  for (int step = 0; step < 4 * kSideSteps; ++step) outline.push_back(rounded(border_bearing(camera, step)));
  return outline;
}

}  // namespace roomcal::tools
