#include "tools/simulate/devices.h"

#include <gtest/gtest.h>

#include "runtime/camera/camera.h"
#include "tools/common/error.h"

namespace roomcal::tools {
namespace {

TEST(Devices, EverySensor_IsMountedAndEveryCameraHasALens) {
  ASSERT_EQ(known_devices().size(), 4u);
  for (const PaperDevice& device : known_devices()) {
    std::vector<std::string> mounted;
    for (std::size_t i = 1; i < device.cameras.size(); ++i) mounted.push_back(device.cameras[i].name);
    for (const DeviceLidar& lidar : device.lidars) mounted.push_back(lidar.name);
    ASSERT_EQ(device.edges.size(), mounted.size());
    for (std::size_t i = 0; i < device.edges.size(); ++i) EXPECT_EQ(device.edges[i].to, mounted[i]);
    for (const DeviceCamera& camera : device.cameras) EXPECT_TRUE(camera::Camera::create(camera.nominal).ok());
  }
}

TEST(Devices, Scaled_SeesTheSameFieldWithFewerPixels) {
  const PaperDevice& device = device_named("backpack");
  const PaperDevice small = scaled(device, 0.2);
  const camera::Intrinsics &full = device.cameras[0].nominal, &fifth = small.cameras[0].nominal;
  ASSERT_EQ(fifth.width_px, 461);
  ASSERT_EQ(fifth.height_px, 768);
  const camera::Camera large = camera::Camera::create(full).value(), little = camera::Camera::create(fifth).value();
  for (const Vec2& corner : {Vec2(-0.5, -0.5), Vec2(full.width_px - 0.5, 0.3 * full.height_px - 0.5)}) {
    Vec3 bearing, same;
    ASSERT_TRUE(large.unproject(corner, bearing).ok());
    const Vec2 share((corner.x() + 0.5) / full.width_px, (corner.y() + 0.5) / full.height_px);
    ASSERT_TRUE(little.unproject(Vec2(share.x() * fifth.width_px - 0.5, share.y() * fifth.height_px - 0.5), same).ok());
    EXPECT_LT((bearing - same).norm(), 1e-12);
  }
}

TEST(Devices, Mounting_TurnsAboutFixedAxesXThenYThenZ) {
  const MountingEdge edge{"to", "from", {90, 90, 0}, {1, 2, 3}};
  // e_z --Rx(90)--> -e_y --Ry(90)--> -e_y
  EXPECT_LT((edge.T_to_from() * Vec3::UnitZ() - Vec3(1, 1, 3)).norm(), 1e-12);
}

TEST(Devices, RobotsSecondCamera_LooksAlongTheFirstOnesX) {
  // T_cam1_cam0 = Ry(90): a point on cam1's axis is at -x of cam0.
  const SE3 T_cam0_cam1 = device_named("mobile_robot").edges[0].T_to_from().inverse();
  EXPECT_LT((T_cam0_cam1.R.col(2) + Vec3::UnitX()).norm(), 1e-12);
}

TEST(Devices, OtherLidars_ReplaceTheSpinningOnesOnly) {
  for (const DeviceLidar& lidar : with_lidars(device_named("backpack"), "xt32").lidars) EXPECT_EQ(lidar.unit, "xt32");
  EXPECT_EQ(with_lidars(device_named("tls"), "").lidars[0].unit, kTlsKind);
  EXPECT_THROW(with_lidars(device_named("tls"), "xt32"), ToolError);
  EXPECT_THROW(with_lidars(device_named("stereo_rig"), "xt32"), ToolError);
}

TEST(Devices, UnknownName_ListsTheKnown) {
  try {
    device_named("toaster");
    FAIL();
  } catch (const ToolError& error) {
    EXPECT_NE(std::string(error.what()).find("backpack"), std::string::npos);
  }
}

}  // namespace
}  // namespace roomcal::tools
