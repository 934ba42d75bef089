#include "runtime/calib/misfit.h"

#include <string>

#include <gtest/gtest.h>

#include "tests/runtime/pose/scene.h"

namespace roomcal::calib {
namespace {

using pose::ImageScene;
using pose::MapScene;

/// One camera's look into a room, and what explain_misfit() says when a thing is wrong with it.
class Misfit : public testing::Test {
 protected:
  void SetUp() override {
    truth::Random random(5);
    room_ = truth::make_room(random);
    map_ = pose::make_map_scene(room_, {}, 1);
    const auto device = truth::make_device(random, 1, truth::LensKind::kWide);
    spec_.name = "cam0";
    spec_.camera = device[0].camera;
    const SE3 T_room_cam = truth::random_T_room_rig(random) * device[0].T_rig_cam;
    pose::ShotOptions options;
    options.sigma_px = 0.01;
    options.missed = options.false_alarms = 0;
    image_ = pose::make_image_scene(room_, spec_.camera, T_room_cam, options, random);
    ASSERT_GT(image_.observations.size(), 12u);
  }

  std::string explain() {
    std::vector<std::byte> step(1 << 16), scratch(4 << 20);
    Arena step_arena(step), scratch_arena(scratch);
    const Reason reason = explain_misfit(spec_, image_.observations, map_.index, step_arena, scratch_arena);
    EXPECT_EQ(step_arena.used(), 0u);
    EXPECT_EQ(scratch_arena.used(), 0u);
    return std::string(reason.view());
  }

  std::vector<truth::RoomMarker> room_;
  MapScene map_;
  CameraSpec spec_;
  ImageScene image_;
};

TEST_F(Misfit, RingsOfAnotherRadius_NameTheRadius) {
  for (pose::Observation& o : image_.observations) {
    o.major_px *= 1.3;
    o.minor_px *= 1.3;
  }
  ASSERT_EQ(pose::locate(spec_.camera, image_.observations, map_.index).status.code(), StatusCode::kNotFound);
  const std::string reason = explain();
  EXPECT_EQ(reason.rfind("cam0: its rings look 1.3", 0), 0u) << reason;
}

TEST_F(Misfit, IntrinsicsOfAnotherCamera_SaysHowWellItFits) {
  camera::Intrinsics other = spec_.camera.intrinsics();
  other.fy_px *= 1.003;
  spec_.camera = camera::Camera::create(other).value();
  ASSERT_EQ(pose::locate(spec_.camera, image_.observations, map_.index).status.code(), StatusCode::kNotFound);
  const std::string reason = explain();
  EXPECT_NE(reason.find("intrinsics"), std::string::npos) << reason;
}

TEST_F(Misfit, AnotherRoom_IsNotExplained) {
  truth::Random random(77);
  map_ = pose::make_map_scene(truth::make_room(random), {}, 2);
  EXPECT_EQ(explain(), "");
}

}  // namespace
}  // namespace roomcal::calib
