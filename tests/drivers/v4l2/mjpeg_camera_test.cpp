#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/drivers/image/jpeg_writer.h"
#include "tests/drivers/v4l2/rig.h"

namespace roomcal::drivers::test {
namespace {

using ports::ImageFault;

class MjpegCamera : public testing::Test {
 protected:
  MjpegCamera() {
    for (std::size_t i = 0; i < grey.size(); ++i)
      grey[i] = static_cast<uint8_t>(128 + 100 * std::sin(static_cast<double>(i % 64) * 0.1));
    jpeg = write_jpeg({grey.data(), 64, 48});
    rig.options.formats.clear();
    static_cast<void>(rig.options.formats.push_back(PixelFormat::kMjpeg));
    rig.camera.fourccs[0] = V4L2_PIX_FMT_MJPEG;
    rig.camera.stride = 0;  // as drivers say of compressed formats
    rig.camera.jpeg = jpeg;
  }

  std::vector<uint8_t> grey = std::vector<uint8_t>(64 * 48);
  std::vector<std::byte> jpeg;
  Rig rig;
};

TEST_F(MjpegCamera, Images_AreDecoded) {
  ASSERT_TRUE(rig.source().start().ok());
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(rig.next().ok());
    for (std::size_t at = 0; at < grey.size(); ++at) ASSERT_NEAR(rig.pixels[at], grey[at], 4);
  }
  EXPECT_EQ(rig.source().health().last_fault, ImageFault::kCount);
}

TEST_F(MjpegCamera, ImageThatEndsEarly_IsUndecodableAndNotHandedOver) {
  ASSERT_TRUE(rig.source().start().ok());
  ASSERT_TRUE(rig.next().ok());
  rig.camera.missing_bytes = 20;
  for (int i = 0; i < 5 && rig.source().health().restarts == 0; ++i) EXPECT_FALSE(rig.next(40 * kMs).ok());
  EXPECT_GE(rig.faults(ImageFault::kUndecodable), 3U);
  EXPECT_EQ(rig.source().health().restarts, 1U);
  rig.camera.missing_bytes = 0;
  EXPECT_GT(rig.images(kS), 20);
}

TEST_F(MjpegCamera, StartedAgain_TakesNoMoreMemory) {
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(rig.source().start().ok());
    ASSERT_TRUE(rig.next().ok());
    rig.source().stop();
  }
}

}  // namespace
}  // namespace roomcal::drivers::test
