#include "tools/bake/marker_shape.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/tools/bake/synthetic_survey.h"

namespace roomcal::tools {
namespace {

constexpr double kRadius_m = 0.085;
const Vec3 kNormal = Vec3(0.1, -0.05, 1).normalized();

/// The ellipse through the image of a circle's rim; a lens bends it by less than the noise.
marker::Ellipse image_of_rim(const StereoRig& rig, Side side, const SE3& T_left_room) {
  const Vec3 u = kNormal.unitOrthogonal(), v = kNormal.cross(u);
  std::vector<cv::Point2f> rim;
  for (int i = 0; i < 48; ++i) {
    const double t = 2 * kPi * i / 48;
    Vec2 px;
    EXPECT_TRUE(rig.project(side, T_left_room * Vec3(kRadius_m * (std::cos(t) * u + std::sin(t) * v)), px).ok());
    rim.emplace_back(static_cast<float>(px.x()), static_cast<float>(px.y()));
  }
  const cv::RotatedRect e = cv::fitEllipseDirect(rim);
  const bool tall = e.size.height > e.size.width;
  return {Vec2(e.center.x, e.center.y), std::max<double>(e.size.width, e.size.height),
          std::min<double>(e.size.width, e.size.height), deg_to_rad(e.angle + (tall ? 90.0 : 0.0))};
}

/// One marker at the origin, seen from some places around.
struct OneMarker {
  Survey survey;
  Reconstruction map;

  explicit OneMarker(int views) {
    map.rig = test::make_stereo_rig();
    map.views.resize(static_cast<std::size_t>(views));
    for (std::size_t v = 0; v < map.views.size(); ++v) {
      const Vec3 place(0.5 * std::cos(2.1 * static_cast<double>(v)), 0.5 * std::sin(2.1 * static_cast<double>(v)), 1.3);
      Mat33 R;
      const Vec3 z = (-place).normalized(), x = z.cross(Vec3::UnitY()).normalized();
      R << x, z.cross(x), z;
      map.views[v].T_room_left = {R, place};
      map.views[v].placed = true;
      map.order.push_back(v);
      StereoView view;
      for (const Side side : kBothSides) {
        view.seen[side].push_back(
            {Vec2::Zero(), Mat22::Identity(), image_of_rim(map.rig, side, map.views[v].T_room_left.inverse())});
        map.views[v].point[side] = {0};
      }
      survey.views.push_back(view);
    }
    map.add_point({Vec3::Zero(), Mat33::Identity()});
  }
};

TEST(MarkerShape, Ellipses_GiveNormalAndRadius) {
  const OneMarker one(5);
  const auto shape = fit_shape(one.survey, one.map, collect_sights(one.map)[0], Vec3::Zero(), Vec3(0.3, 0, 1));
  ASSERT_TRUE(shape);
  EXPECT_EQ(shape->ellipses, 10U);
  EXPECT_LT(std::acos(std::min(1.0, shape->normal_room.dot(kNormal))), deg_to_rad(0.3));
  EXPECT_NEAR(shape->radius_m, kRadius_m, 2e-4);
  EXPECT_LT(shape->sigma_radius_m, 1e-3);
}

TEST(MarkerShape, StartOnTheOtherSide_TurnsToTheCameras) {
  const OneMarker one(5);
  const auto shape = fit_shape(one.survey, one.map, collect_sights(one.map)[0], Vec3::Zero(), -kNormal);
  ASSERT_TRUE(shape);
  EXPECT_GT(shape->normal_room.dot(kNormal), 0.999);
}

TEST(MarkerShape, TwoEllipses_AreTooFew) {
  const OneMarker one(1);
  EXPECT_FALSE(fit_shape(one.survey, one.map, collect_sights(one.map)[0], Vec3::Zero(), kNormal));
}

}  // namespace
}  // namespace roomcal::tools
