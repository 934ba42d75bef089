#include "tools/simulate/room_view.h"

#include <gtest/gtest.h>

#include "tools/common/error.h"
#include "tools/simulate/make_room.h"
#include "tools/simulate/marker_truth.h"
#include "tools/simulate/planar.h"

namespace roomcal::tools {
namespace {

/// One sheet in the middle of a wall, even light, seen head on.
struct Frontal {
  Scene scene;
  SE3 T_room_cam;
};

Frontal frontal_sheet() {
  Frontal frontal;
  frontal.scene = make_room({.markers = 0, .distractors = 0});
  Scene& scene = frontal.scene;
  scene.lamps.clear();
  scene.ambient = 1;
  Plane& wall = scene.walls[2];
  Decal sheet;
  sheet.marker_id = 0;
  sheet.centre = wall.size / 2;
  sheet.angle_rad = 0.4;
  sheet.half_size = Vec2(kSheetWidth_m, kSheetHeight_m) / 2;
  sheet.radius_m = kMarkerRadius_m;
  wall.decals.push_back(sheet);
  frontal.T_room_cam.R << wall.axis_u, -wall.axis_v, -wall.normal;
  frontal.T_room_cam.t =
      wall.point(sheet.centre) + 1.2 * wall.normal;  // on the axis: by symmetry the centroid is the centre
  return frontal;
}

camera::Camera camera_of(const camera::Intrinsics& lens) {
  auto made = camera::Camera::create(lens);
  require(made.status(), "lens");
  return made.value();
}

const camera::Intrinsics kPinhole{camera::Model::kPinholeRadtan, 160, 120, 400, 400, 79.3, 59.8, {-0.1, 0.05, 0, 0}};
const camera::Intrinsics kFisheye{camera::Model::kKannalaBrandt, 160, 120, 400, 400, 79.3, 59.8, {-0.02, 0.005, 0, 0}};

TEST(RoomView, FrontalMarker_IsWhereTruthSays_BothLenses) {
  const Frontal frontal = frontal_sheet();
  const LitScene lit(frontal.scene);
  for (const camera::Intrinsics& lens : {kPinhole, kFisheye}) {
    const camera::Camera camera = camera_of(lens);
    const auto truths = project_markers(frontal.scene, camera, frontal.T_room_cam);
    ASSERT_EQ(truths.size(), 1u);
    EXPECT_EQ(truths[0].visible, 1);
    const RoomView view(lit, camera, frontal.T_room_cam);
    const RadianceImage image = integrate(view, lens.width_px, lens.height_px, {});
    double sum = 0;
    Vec2 moment = Vec2::Zero();
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const Vec2 offset = Vec2(x, y) - truths[0].uv_px;
        if (offset.norm() > 0.5 * truths[0].outer.major_px + 2.4) continue;
        const double dark = kPaperAlbedo - image.at(x, y);
        sum += dark;
        moment += dark * offset;
      }
    }
    EXPECT_LT((moment / sum).norm(), 0.003) << moment / sum;
    // Dark area = the share of ink on the disc, which also checks the scale of the picture.
    const double disc_px = kPi / 4 * truths[0].outer.major_px * truths[0].outer.minor_px;
    EXPECT_NEAR(sum / (kPaperAlbedo - kInkAlbedo) / disc_px, 1 - 0.7225 + 0.49 - 0.3025 + 0.16 - 0.0625, 2e-3);
  }
}

TEST(RoomView, LampsLight_FallsWithTheSquareOfTheDistance) {
  Scene scene = make_room({.markers = 0, .distractors = 0});
  scene.ambient = 0;
  scene.lamps = {{Vec3(1.5, 2, 1), Vec2::Zero(), 1, true}};
  const double near = irradiance(scene, Vec3(1.5, 2, 0), Vec3::UnitZ());
  scene.lamps[0].centre.z() = 2;
  EXPECT_NEAR(near, 1, 1e-12);
  EXPECT_NEAR(irradiance(scene, Vec3(1.5, 2, 0), Vec3::UnitZ()), 0.25, 1e-12);
}

TEST(RoomView, BodyBeforeALamp_ThrowsAShadow) {
  Scene scene = make_room({.markers = 0, .distractors = 0});
  scene.ambient = 0.1;
  scene.lamps = {{Vec3(1.5, 2, 2), Vec2::Zero(), 1, true}};
  scene.bodies = {make_box("box", Vec3(1.5, 2, 1), Vec3(0.1, 0.1, 0.1), 0.3, 0.5)};
  EXPECT_NEAR(irradiance(scene, Vec3(1.5, 2, 0), Vec3::UnitZ()), 0.1, 1e-12);
  EXPECT_GT(irradiance(scene, Vec3(2.3, 2, 0), Vec3::UnitZ()), 0.2);
}

TEST(RoomView, SecondLookAtTheSameRoom_IsTheSamePicture) {
  const Frontal frontal = frontal_sheet();
  const LitScene lit(frontal.scene);
  const camera::Camera camera = camera_of(kFisheye);
  const RoomView view(lit, camera, frontal.T_room_cam);
  EXPECT_EQ(integrate(view, 160, 120, {}).values, integrate(view, 160, 120, {}).values);
}

}  // namespace
}  // namespace roomcal::tools
