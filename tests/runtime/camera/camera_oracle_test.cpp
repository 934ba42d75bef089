#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "tests/runtime/camera/lenses.h"

namespace roomcal::camera {
namespace {

using test::bearing_at;
using test::kLenses;
using test::make_camera;

cv::Matx33d matrix_of(const Intrinsics& in) { return {in.fx_px, 0, in.cx_px, 0, in.fy_px, in.cy_px, 0, 0, 1}; }

// Points all over the part of the field that OpenCV can do: it knows no rays at or behind the camera's plane.
std::vector<Vec3> field_points(const Camera& camera, double limit_rad) {
  std::vector<Vec3> points;
  for (int i = 0; i <= 50; ++i)
    for (int a = 0; a < 12; ++a)
      points.push_back((1.0 + 0.1 * a) * bearing_at(std::min(camera.max_angle_rad(), limit_rad) * i / 51, 0.5 * a));
  return points;
}

TEST(CameraOracle, OpenCv_ProjectsToTheSamePixels) {
  for (const auto& lens : kLenses) {
    const Camera camera = make_camera(lens);
    const std::vector<Vec3> points = field_points(camera, deg_to_rad(85));
    std::vector<cv::Point3d> points_cv;
    for (const Vec3& p : points) points_cv.emplace_back(p.x(), p.y(), p.z());
    const auto& d = lens.intrinsics.distortion;
    const cv::Vec4d distortion(d[0], d[1], d[2], d[3]);
    std::vector<cv::Point2d> expected;
    if (lens.intrinsics.model == Model::kPinholeRadtan)
      cv::projectPoints(points_cv, cv::Vec3d(), cv::Vec3d(), matrix_of(lens.intrinsics), distortion, expected);
    else
      cv::fisheye::projectPoints(points_cv, expected, cv::Vec3d(), cv::Vec3d(), matrix_of(lens.intrinsics), distortion);
    for (std::size_t i = 0; i < points.size(); ++i) {
      Vec2 px;
      ASSERT_TRUE(camera.project(points[i], px).ok()) << lens.name;
      const Vec2 oracle_px(expected[i].x, expected[i].y);
      EXPECT_LT((px - oracle_px).norm(), 1e-11 * (1 + oracle_px.norm())) << lens.name << " " << points[i].transpose();
    }
  }
}

TEST(CameraOracle, OpenCvPinholeJacobian_AgreesWithOurs) {
  const auto& lens = kLenses[3];
  const Camera camera = make_camera(lens);
  const auto& d = lens.intrinsics.distortion;
  for (const Vec3& point : field_points(camera, deg_to_rad(60))) {
    std::vector<cv::Point2d> px_cv;
    cv::Mat J;  // 2 x (3 rotation, 3 translation, fx fy, cx cy, k1 k2 p1 p2)
    cv::projectPoints(std::vector<cv::Point3d>{{point.x(), point.y(), point.z()}}, cv::Vec3d(), cv::Vec3d(),
                      matrix_of(lens.intrinsics), cv::Vec4d(d[0], d[1], d[2], d[3]), px_cv, J);
    Vec2 px;
    ProjectJacobians ours;
    ASSERT_TRUE(camera.project(point, px, &ours).ok());
    for (int row = 0; row < 2; ++row) {
      for (int col = 0; col < 3; ++col)
        EXPECT_NEAR(ours.J_point(row, col), J.at<double>(row, 3 + col), 1e-9 * ours.J_point.norm());
      for (int col = 0; col < kIntrinsicsCount; ++col)
        EXPECT_NEAR(ours.J_intrinsics(row, col), J.at<double>(row, 6 + col), 1e-9 * ours.J_intrinsics.norm());
    }
  }
}

}  // namespace
}  // namespace roomcal::camera
