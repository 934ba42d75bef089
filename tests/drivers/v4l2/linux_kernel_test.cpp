#include "drivers/v4l2/linux_kernel.h"

#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "drivers/os/linux_clocks.h"
#include "tests/drivers/v4l2/rig.h"

namespace roomcal::drivers::test {
namespace {

namespace fs = std::filesystem;

// A sysfs of our own.
class LinuxKernelTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(sys / "class/video4linux"); }
  void TearDown() override { fs::remove_all(sys); }

  void add_node(const std::string& node, const std::string& device, const std::string& title,
                const std::string& index) {
    const fs::path folder = sys / "devices" / device / "video4linux" / node;
    fs::create_directories(folder);
    std::ofstream(folder / "name") << title << "\n";
    std::ofstream(folder / "index") << index << "\n";
    fs::create_directory_symlink(sys / "devices" / device, folder / "device");
    fs::create_directory_symlink("../../devices/" + device + "/video4linux/" + node, sys / "class/video4linux" / node);
  }

  fs::path sys = fs::temp_directory_path() / ("roomcal_sysfs_" + std::to_string(::getpid()));
  std::string root = sys.string();
  LinuxV4l2Kernel kernel{root};
};

TEST_F(LinuxKernelTest, UsbCamera_IsDescribedFromSysfs) {
  const std::string device = "pci0000:00/0000:00:14.0/usb1/1-2/1-2:1.0";
  add_node("video3", device, "HD Webcam: HD Webcam", "1");
  std::ofstream(sys / "devices/pci0000:00/0000:00:14.0/usb1/1-2/serial") << "8A3F01\n";
  VideoNode node;
  ASSERT_EQ(kernel.describe("video3", node), 0);
  EXPECT_EQ(node.name.view(), "video3");
  EXPECT_EQ(node.path.view(), device);
  EXPECT_EQ(node.title.view(), "HD Webcam: HD Webcam");
  EXPECT_EQ(node.serial.view(), "8A3F01");
  EXPECT_EQ(node.index, 1);
}

TEST_F(LinuxKernelTest, DeviceWithoutSerial_HasNone) {
  add_node("video0", "platform/vivid.0", "vivid-000-vid-cap", "0");
  VideoNode node;
  node.serial = "left over";
  ASSERT_EQ(kernel.describe("video0", node), 0);
  EXPECT_TRUE(node.serial.empty());
  EXPECT_EQ(node.path.view(), "platform/vivid.0");
  EXPECT_EQ(kernel.describe("video1", node), -ENOENT);
}

TEST_F(LinuxKernelTest, MoreNodesThanOneCallOfTheKernelReturns_AreAllListed) {
  for (int i = 0; i < 200; ++i) add_node("video" + std::to_string(i), "platform/a" + std::to_string(i), "a", "0");
  add_node("v4l-subdev0", "platform/sub", "sub", "0");
  add_node("radio0", "platform/radio", "radio", "0");
  std::vector<NodeName> names(300);
  ASSERT_EQ(kernel.list(names), 200);
  std::array<NodeName, 5> few;
  EXPECT_EQ(kernel.list(few), 200);  // there are more than there is room for
  EXPECT_EQ(few[4].view().substr(0, 5), "video");
}

TEST_F(LinuxKernelTest, NoVideoDriver_IsSaid) {
  fs::remove_all(sys);
  std::array<NodeName, 4> names;
  EXPECT_EQ(kernel.list(names), -ENOENT);
}

TEST_F(LinuxKernelTest, UsbDevice_IsTakenOffItsPortAndPutBack) {
  const fs::path folder = sys / "bus/usb/devices/1-2";
  fs::create_directories(folder);
  std::ofstream(folder / "authorized") << "1";
  EXPECT_EQ(kernel.reset_usb_device("1-2"), 1);
  EXPECT_EQ(kernel.reset_usb_device("1-9"), -ENOENT);
  EXPECT_EQ(kernel.reset_usb_device(std::string(600, 'x')), -ENOENT);
}

TEST_F(LinuxKernelTest, NodeThatIsNotThereOrNoCamera_FailsByItsErrno) {
  EXPECT_EQ(kernel.open("video_that_is_not_there"), -ENOENT);
  FixedText<255> target;
  EXPECT_EQ(kernel.read_link("/dev/v4l/by-path/none", target), -ENOENT);
  EXPECT_EQ(kernel.read_link("/", target), -EINVAL);
  const int null = kernel.open("null");
  ASSERT_GE(null, 0);
  int argument = 0;
  EXPECT_EQ(kernel.ioctl(null, VIDIOC_QUERYCAP, &argument), -ENOTTY);
  std::span<const std::byte> bytes;
  EXPECT_EQ(kernel.map(null, 4096, 0, bytes), -ENODEV);
  kernel.close(null);
}

TEST(UsbDeviceOf, PathBelowAUsbPort_IsTheDevice) {
  EXPECT_EQ(usb_device_of("pci0000:00/0000:00:14.0/usb1/1-2/1-2.3/1-2.3:1.0"), "1-2.3");
  for (const char* path : {"platform/vivid.0", "pci0000:00/0000:00:14.0", "", "1-2:1.0", "a/b-c", "x/1-3/1-2:1.0"})
    EXPECT_EQ(usb_device_of(path), "") << path;
}

// This machine's own kernel, whatever it has: a camera of this name it has not.
TEST(V4l2OnThisMachine, CameraThatIsNotThere_IsNotFoundAndWaitedFor) {
  LinuxV4l2Kernel kernel;
  const LinuxClocks clocks;
  Lines lines;
  V4l2ImageSource source("cam0", options_for("serial:no such camera"), kernel, clocks, lines);
  const Status started = source.start();
  EXPECT_EQ(started.code(), StatusCode::kNotFound);
  EXPECT_EQ(source.health().state, ports::SourceState::kRecovering);
  std::vector<uint8_t> pixels(64 * 48);
  ports::ImageFacts facts;
  const int64_t began = clocks.now_ns();
  EXPECT_EQ(source.next(20 * kMs, {pixels.data(), 64, 48}, facts).code(), StatusCode::kUnavailable);
  EXPECT_GE(clocks.now_ns() - began, 20 * kMs);
  EXPECT_EQ(lines.with("not found"), 1);
}

}  // namespace
}  // namespace roomcal::drivers::test
