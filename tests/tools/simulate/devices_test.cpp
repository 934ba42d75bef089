#include "tools/simulate/devices.h"

#include <gtest/gtest.h>

#include "runtime/camera/camera.h"
#include "tools/common/error.h"

namespace roomcal::tools {
namespace {

TEST(Devices, EveryCamera_IsMountedAndHasALens) {
  ASSERT_EQ(known_devices().size(), 4u);
  for (const PaperDevice& device : known_devices()) {
    ASSERT_EQ(device.edges.size() + 1, device.cameras.size());
    for (std::size_t i = 0; i < device.edges.size(); ++i) EXPECT_EQ(device.edges[i].to, device.cameras[i + 1].name);
    for (const DeviceCamera& camera : device.cameras) EXPECT_TRUE(camera::Camera::create(camera.nominal).ok());
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
