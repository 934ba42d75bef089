#include "drivers/v4l2/camera_key.h"

#include <gtest/gtest.h>

namespace roomcal::drivers {
namespace {

VideoNode webcam() {
  VideoNode node;
  node.name = "video3";
  node.path = "pci0000:00/0000:00:14.0/usb1/1-2/1-2.3/1-2.3:1.0";
  node.title = "HD Webcam: HD Webcam";
  node.serial = "8A3F01";
  node.index = 0;
  return node;
}

bool fits(const char* key) {
  EXPECT_TRUE(CameraKey::check(key).ok()) << key;
  return CameraKey(key).fits(webcam(), {});
}

TEST(CameraKey, WhatStaysTheSame_Fits) {
  for (const char* key :
       {"port:1-2.3", "port:1-2.3:1.0", "port:*-2.3", "port:0000:00:14.0/*-2.3", "port:0000:00:14.0/usb1/*-2/*-2.3",
        "serial:8A3F01", "name:HD Webcam", "name:HD Webcam: HD Webcam", "index:0", "bus:anything",
        "serial:8A3F01 + index:0", "port:*-2.3 + name:HD Webcam + serial:8A3F01"})
    EXPECT_TRUE(fits(key)) << key;
}

TEST(CameraKey, WhatIsOtherwise_DoesNot) {
  for (const char* key : {"port:1-2", "port:*-2.3.1", "port:2-2.3", "port:*-3", "port:1-2.3/0000:00:14.0",
                          "port:0000:00:15.0/*-2.3", "port:-2.3", "serial:8A3F0", "serial:8a3f01", "name:HD",
                          "name:Webcam", "index:1", "serial:8A3F01 + index:1", "port:*-2.3 + name:Other"})
    EXPECT_EQ(fits(key), std::string_view(key) == "port:1-2")
        << key;  // the hub that it hangs on is a part of its path too
}

TEST(CameraKey, Bus_IsAskedOfTheOpenDevice) {
  const CameraKey key("name:HD Webcam + bus:usb-0000:00:14.0-2.3");
  EXPECT_TRUE(key.fits(webcam(), {}));
  EXPECT_TRUE(key.fits_bus("usb-0000:00:14.0-2.3"));
  EXPECT_FALSE(key.fits_bus("usb-0000:00:14.0-2"));
  EXPECT_TRUE(CameraKey("name:HD Webcam").fits_bus("anything"));
}

TEST(CameraKey, LinkOfUdev_FitsTheNodeThatItPointsTo) {
  const CameraKey key("/dev/v4l/by-path/pci-0000:00:14.0-usb-0:2:1.0-video-index0");
  EXPECT_TRUE(key.is_link());
  EXPECT_TRUE(key.fits(webcam(), "../../video3"));
  EXPECT_FALSE(key.fits(webcam(), "../../video33"));
  EXPECT_FALSE(key.fits(webcam(), ""));
}

TEST(CameraKey, WhatIsNone_IsRefusedByName) {
  const auto detail = [](const char* key) {
    const Status checked = CameraKey::check(key);
    EXPECT_EQ(checked.code(), StatusCode::kInvalidArgument) << key;
    return std::string(checked.detail());
  };
  EXPECT_NE(detail("").find("no key"), std::string::npos);
  EXPECT_NE(detail("/dev/video0").find("device number changes"), std::string::npos);
  for (const char* key :
       {"video0", "cam", "serial:", "serial", "usb:1-2", "serial:A + ", "serial:A + colour:red", ":", " + "})
    EXPECT_NE(detail(key).find("part"), std::string::npos) << key;
  for (const char* key : {"index:x", "index:-1", "index:1 ", "index:99999999999"})
    EXPECT_NE(detail(key).find("index"), std::string::npos) << key;
}

}  // namespace
}  // namespace roomcal::drivers
