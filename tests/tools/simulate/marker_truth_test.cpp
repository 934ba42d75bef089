#include "tools/simulate/marker_truth.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tools/simulate/make_room.h"
#include "tools/simulate/planar.h"
#include "tools/simulate/shot.h"

namespace roomcal::tools {
namespace {

/// Independent of runtime/camera: the textbook formulas, written out.
Vec2 textbook_projection(const camera::Intrinsics& k, const Vec3& p) {
  const auto& d = k.distortion;
  if (k.model == camera::Model::kKannalaBrandt) {
    const double rho = std::hypot(p.x(), p.y()), theta = std::atan2(rho, p.z()), t2 = theta * theta;
    const double r = theta * (1 + t2 * (d[0] + t2 * (d[1] + t2 * (d[2] + t2 * d[3]))));
    return {k.fx_px * r * p.x() / rho + k.cx_px, k.fy_px * r * p.y() / rho + k.cy_px};
  }
  const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y, radial = 1 + r2 * (d[0] + r2 * d[1]);
  return {k.fx_px * (x * radial + 2 * d[2] * x * y + d[3] * (r2 + 2 * x * x)) + k.cx_px,
          k.fy_px * (y * radial + d[2] * (r2 + 2 * y * y) + 2 * d[3] * x * y) + k.cy_px};
}

TEST(MarkerTruth, Centres_AgreeWithTheTextbook) {
  const Scene scene = make_room({.seed = 2, .pillar = true});
  const auto markers = markers_of(scene);
  for (const PaperDevice& device : known_devices()) {
    const Stand stand = place_device(scene, device, {.seed = 4});
    int seen = 0;
    for (const TrueCamera& camera : stand.cameras) {
      const SE3 T_cam_room = camera.T_room_cam.inverse();
      for (const MarkerTruth& truth : project_markers(scene, camera.camera, camera.T_room_cam)) {
        const Vec3 centre_cam = T_cam_room * markers[static_cast<std::size_t>(truth.id)].centre_room;
        EXPECT_LT((truth.uv_px - textbook_projection(camera.camera.intrinsics(), centre_cam)).norm(), 1e-9);
        EXPECT_NEAR(truth.distance_m, centre_cam.norm(), 1e-12);
        seen += truth.visible == 1 ? 1 : 0;
      }
    }
    EXPECT_GE(seen, 20) << device.name;
  }
}

TEST(MarkerTruth, Outline_OfAnEllipse_GivesItsAxes) {
  std::vector<Vec2> outline;
  const double a = 20, b = 7, turn = -0.6;
  for (int i = 0; i < 720; ++i) {
    const double t = 2 * kPi * i / 720;
    outline.emplace_back(100 + a * std::cos(t) * std::cos(turn) - b * std::sin(t) * std::sin(turn),
                         50 + a * std::cos(t) * std::sin(turn) + b * std::sin(t) * std::cos(turn));
  }
  const CircleImage image = measure_outline(outline);
  EXPECT_NEAR(image.centre_px.x(), 100, 1e-9);
  EXPECT_NEAR(image.centre_px.y(), 50, 1e-9);
  EXPECT_NEAR(image.major_px, 2 * a, 1e-3);
  EXPECT_NEAR(image.minor_px, 2 * b, 1e-3);
  EXPECT_NEAR(image.angle_rad, turn, 1e-6);
}

TEST(MarkerTruth, MarkerBehindABox_IsNotVisible) {
  Scene scene = make_room({.seed = 2});
  const TrueCamera camera = place_device(scene, device_named("mobile_robot"), {.seed = 4}).cameras[0];
  const auto all = project_markers(scene, camera.camera, camera.T_room_cam);
  const auto whole = std::find_if(all.begin(), all.end(), [](const MarkerTruth& m) { return m.visible == 1; });
  ASSERT_NE(whole, all.end());
  const Vec3 centre_room = markers_of(scene)[static_cast<std::size_t>(whole->id)].centre_room;
  scene.bodies.push_back(make_box("box", (centre_room + camera.T_room_cam.t) / 2, Vec3(0.12, 0.12, 0.12), 0.4, 0.5));
  for (const MarkerTruth& marker : project_markers(scene, camera.camera, camera.T_room_cam)) {
    EXPECT_NE(marker.id, whole->id);
  }
}

}  // namespace
}  // namespace roomcal::tools
