#include "drivers/v4l2/find_camera.h"

#include <cerrno>

#include <gtest/gtest.h>

#include "tests/drivers/v4l2/fake_kernel.h"

namespace roomcal::drivers::test {
namespace {

using ports::ImageFault;

class FindCamera : public testing::Test {
 protected:
  Trouble find(const char* key) { return find_camera(kernel, CameraKey(key), found); }

  FakeClocks clocks;
  FakeKernel kernel{clocks};
  FoundCamera found;
};

TEST_F(FindCamera, MetadataNodeOfTheSameCamera_IsNotMeant) {
  kernel.add("video0", "usb1/1-2/1-2:1.0", "A1");
  FakeCamera& metadata = kernel.add("video1", "usb1/1-2/1-2:1.0", "A1");
  metadata.capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;  // though its device captures video
  EXPECT_TRUE(find("serial:A1").none());
  EXPECT_EQ(found.node.name.view(), "video0");
  EXPECT_EQ(kernel.open_descriptors(), 0);
}

TEST_F(FindCamera, SeveralNodesOfOneDevice_AreToldApartByIndex) {
  kernel.add("video0", "platform/isp");
  kernel.add("video1", "platform/isp").node.index = 1;
  EXPECT_EQ(find("port:isp").fault, ImageFault::kNotFound);
  EXPECT_EQ(found.others.view(), "video0 at platform/isp and video1 at platform/isp");
  EXPECT_TRUE(find("port:isp + index:1").none());
  EXPECT_EQ(found.node.name.view(), "video1");
  EXPECT_TRUE(found.others.empty());
}

TEST_F(FindCamera, SamePartsButForTheBus_AreToldApartByIt) {
  kernel.add("video0", "platform/vivid.0").bus_info = "platform:vivid-000";
  kernel.add("video1", "platform/vivid.0").bus_info = "platform:vivid-001";
  EXPECT_TRUE(find("port:vivid.0 + bus:platform:vivid-001").none());
  EXPECT_EQ(found.node.name.view(), "video1");
}

TEST_F(FindCamera, NoCameraOrNoVideoAtAll_IsNotFound) {
  EXPECT_EQ(find("serial:A1").fault, ImageFault::kNotFound);
  kernel.fail(FakeCall::kList, ENOENT);  // no driver is loaded
  EXPECT_EQ(find("serial:A1").fault, ImageFault::kNotFound);
}

TEST_F(FindCamera, TheOnlyNodeCannotBeOpened_SaysWhy) {
  kernel.add("video0", "usb1/1-2/1-2:1.0", "A1");
  kernel.fail(FakeCall::kOpen, EACCES);
  const Trouble trouble = find("serial:A1");
  EXPECT_EQ(trouble.fault, ImageFault::kDenied);
  EXPECT_EQ(trouble.error_number, EACCES);
}

TEST_F(FindCamera, AnotherNodesTrouble_DoesNotHinder) {
  kernel.add("video0", "platform/isp");
  kernel.add("video1", "platform/isp").node.index = 1;
  kernel.fail(FakeCall::kOpen, EBUSY, 0, 1);
  EXPECT_TRUE(find("port:isp").none());
  EXPECT_EQ(found.node.name.view(), "video1");
}

TEST_F(FindCamera, Link_LeadsToItsNodeOrIsNotFound) {
  kernel.add("video0", "usb1/1-2/1-2:1.0");
  kernel.add("video4", "usb1/1-3/1-3:1.0");
  EXPECT_EQ(find("/dev/v4l/by-path/x").fault, ImageFault::kNotFound);
  kernel.link_to("../../video4");
  EXPECT_TRUE(find("/dev/v4l/by-path/x").none());
  EXPECT_EQ(found.node.name.view(), "video4");
}

}  // namespace
}  // namespace roomcal::drivers::test
