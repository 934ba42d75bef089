#include "tools/common/draw.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "runtime/math/types.h"

namespace roomcal::tools {

namespace {

const cv::Scalar kGreen(80, 220, 60), kOrange(0, 150, 255);
constexpr int kSubpixelBits = 4;

cv::Point fixed_point(const Vec2& px) {
  return {static_cast<int>(std::lround(px.x() * (1 << kSubpixelBits))),
          static_cast<int>(std::lround(px.y() * (1 << kSubpixelBits)))};
}

}  // namespace

cv::Mat canvas(const cv::Mat& grey) {
  cv::Mat picture;
  cv::cvtColor(grey, picture, cv::COLOR_GRAY2BGR);
  return picture * 0.8 + cv::Scalar(25, 25, 25);
}

void draw_detections(cv::Mat& picture, std::span<const marker::Detection> detections) {
  const int thickness = std::max(1, picture.cols / 1200);
  for (const marker::Detection& d : detections) {
    const cv::Scalar& colour = d.status == marker::DetectionStatus::kOk ? kGreen : kOrange;
    const cv::Size axes(static_cast<int>(d.ellipse.major_px * 0.5 * (1 << kSubpixelBits)),
                        static_cast<int>(d.ellipse.minor_px * 0.5 * (1 << kSubpixelBits)));
    cv::ellipse(picture, fixed_point(d.ellipse.centre_px), axes, rad_to_deg(d.ellipse.angle_rad), 0, 360, colour,
                thickness, cv::LINE_AA, kSubpixelBits);
    cv::circle(picture, fixed_point(d.centre_px), 2 << kSubpixelBits, colour, thickness, cv::LINE_AA, kSubpixelBits);
  }
}

}  // namespace roomcal::tools
