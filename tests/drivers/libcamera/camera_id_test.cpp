#include "drivers/libcamera/camera_id.h"

#include <vector>

#include <gtest/gtest.h>

namespace roomcal::drivers {
namespace {

const std::vector<std::string> kIds{"/base/soc/i2c0mux/i2c@1/imx296@1a", "/base/soc/i2c0mux/i2c@0/imx296@1a",
                                    "\\_SB_.PCI0.XHC_.RHUB.HS04-4:1.0-046d:0825", "imx296"};

TEST(CameraId, WholeId_IsTakenEvenIfOthersContainIt) { EXPECT_EQ(find_camera_id(kIds, "imx296").value(), 3U); }

TEST(CameraId, PartOfOne_IsEnough) {
  EXPECT_EQ(find_camera_id(kIds, "i2c@0/imx296").value(), 1U);
  EXPECT_EQ(find_camera_id(kIds, "046d:0825").value(), 2U);
}

TEST(CameraId, PartOfSeveral_IsRefused) {
  const auto found = find_camera_id(kIds, "imx296@1a");
  EXPECT_EQ(found.status().code(), StatusCode::kNotFound);
  EXPECT_STREQ(found.status().detail(), "several cameras have this in their id; name one by its whole id");
}

TEST(CameraId, PartOfNone_IsNotFound) {
  EXPECT_EQ(find_camera_id(kIds, "imx708").status().code(), StatusCode::kNotFound);
  EXPECT_EQ(find_camera_id({}, "imx708").status().code(), StatusCode::kNotFound);
}

}  // namespace
}  // namespace roomcal::drivers
