#include "tools/calibrate/draw_sweeps.h"

#include <algorithm>
#include <array>
#include <string>

#include <opencv2/imgproc.hpp>

#include "tools/common/draw.h"
#include "tools/common/image_io.h"

namespace roomcal::tools {

namespace fs = std::filesystem;

namespace {

constexpr double kNear_m = 0.5, kFar_m = 6;
constexpr std::size_t kMaxDots = 200'000;

/// OpenCV's jet from its red end (near) to its blue end (far).
cv::Scalar colour_of(double distance_m) {
  static const cv::Mat kJet = [] {
    cv::Mat ramp(1, 256, CV_8UC1), jet;
    for (int i = 0; i < 256; ++i) ramp.at<uint8_t>(0, i) = static_cast<uint8_t>(i);
    cv::applyColorMap(ramp, jet, cv::COLORMAP_JET);
    return jet;
  }();
  const double far = std::clamp((distance_m - kNear_m) / (kFar_m - kNear_m), 0.0, 1.0);
  const auto bgr = kJet.at<cv::Vec3b>(0, 255 - static_cast<int>(255 * far));
  return cv::Scalar(bgr[0], bgr[1], bgr[2]);
}

template <typename Visit>
void for_each_point(const LoadedSweep& sweep, const Visit& visit) {
  const std::size_t stride = std::max<std::size_t>(1, sweep.points.size() / kMaxDots);
  const lidar::Sweep view = sweep.view();
  for (std::size_t i = 0; i < view.points.size(); i += stride) {
    const Vec3 p_lidar = view.position_lidar(i);
    if (p_lidar.allFinite()) visit(p_lidar);
  }
}

void draw_in_image(const LoadedSweep& sweep, const camera::Camera& camera, const SE3& T_cam_lidar, cv::Mat& picture) {
  const int radius = std::max(1, picture.cols / 900);
  for_each_point(sweep, [&](const Vec3& p_lidar) {
    const Vec3 p_cam = T_cam_lidar * p_lidar;
    Vec2 px;
    if (!camera.project(p_cam, px).ok()) return;
    if (px.x() < 0 || px.y() < 0 || px.x() >= picture.cols || px.y() >= picture.rows) return;
    cv::circle(picture, cv::Point2d(px.x(), px.y()), radius, colour_of(p_cam.norm()), cv::FILLED);
  });
}

/// Two views of the room beside each other: x-y from above, x-z from the front.
class RoomPlan {
 public:
  explicit RoomPlan(const map::RoomMap& map) {
    for (std::size_t i = 0; i < map.marker_count(); ++i) {
      low_ = low_.cwiseMin(map.marker(i).p_room);
      high_ = high_.cwiseMax(map.marker(i).p_room);
    }
    low_.array() -= kMargin_m;
    high_.array() += kMargin_m;
    const Vec3 size = high_ - low_;
    picture_ = cv::Mat(static_cast<int>(kScale * std::max(size.y(), size.z())), static_cast<int>(kScale * 2 * size.x()),
                       CV_8UC3, cv::Scalar(255, 255, 255));
    for (std::size_t i = 0; i < map.marker_count(); ++i) dot(map.marker(i).p_room, cv::Scalar(170, 170, 170), 5);
  }

  void dot(const Vec3& p_room, const cv::Scalar& colour, int radius) {
    const Vec3 p = p_room - low_;
    const double top = picture_.rows - 1.0;
    cv::circle(picture_, cv::Point2d(kScale * p.x(), top - kScale * p.y()), radius, colour, cv::FILLED);
    const double right = 0.5 * picture_.cols;
    cv::circle(picture_, cv::Point2d(right + kScale * p.x(), top - kScale * p.z()), radius, colour, cv::FILLED);
  }
  void label(const std::string& name, const cv::Scalar& colour) {
    cv::putText(picture_, name, cv::Point(10, 25 * ++labels_), cv::FONT_HERSHEY_SIMPLEX, 0.7, colour, 2, cv::LINE_AA);
  }
  const cv::Mat& picture() const { return picture_; }

 private:
  static constexpr double kScale = 220;  // pixels per metre
  static constexpr double kMargin_m = 0.4;
  Vec3 low_ = Vec3::Constant(1e9), high_ = Vec3::Constant(-1e9);
  cv::Mat picture_;
  int labels_ = 0;
};

const std::array kColours = {cv::Scalar(40, 40, 220), cv::Scalar(200, 120, 0), cv::Scalar(0, 150, 0),
                             cv::Scalar(180, 0, 180)};

}  // namespace

void draw_sweeps(const calib::Outcome& outcome, const map::RoomMap& map, const ShotFolder& shot,
                 const fs::path& folder) {
  bool any = false;
  RoomPlan plan(map);
  for (std::size_t l = 0; l < outcome.lidars.size(); ++l) {
    const calib::LidarOutcome& lidar = outcome.lidars[l];
    if (!lidar.located || shot.sweeps[l].empty()) continue;
    const LoadedSweep& sweep = shot.sweeps[l].front();
    const std::string name(lidar.name.view());
    for (std::size_t c = 0; c < outcome.cameras.size(); ++c) {
      const calib::CameraOutcome& camera = outcome.cameras[c];
      if (!camera.located || shot.images[c].empty()) continue;
      cv::Mat picture = canvas(shot.images[c]);
      draw_in_image(sweep, camera.camera, camera.T_room_cam.inverse() * lidar.T_room_lidar, picture);
      write_image(folder / (std::string(camera.name.view()) + "_" + name + ".png"), picture);
    }
    const cv::Scalar& colour = kColours[l % kColours.size()];
    for_each_point(sweep, [&](const Vec3& p_lidar) { plan.dot(lidar.T_room_lidar * p_lidar, colour, 1); });
    plan.label(name, colour);
    any = true;
  }
  if (any) write_image(folder / "sweeps_registered.png", plan.picture());
}

}  // namespace roomcal::tools
