#include "drivers/libcamera/fourcc_layout.h"

#include <gtest/gtest.h>
#include <libcamera/formats.h>

namespace roomcal::drivers {
namespace {

PixelFormat layout(const libcamera::PixelFormat& format) { return layout_of(format.fourcc(), format.modifier()); }

TEST(FourccLayout, Numbers_AreThoseOfLibcamera) {
  namespace formats = libcamera::formats;
  EXPECT_EQ(layout(formats::R8), PixelFormat::kGrey8);
  EXPECT_EQ(layout(formats::R10), PixelFormat::kGrey10);
  EXPECT_EQ(layout(formats::R12), PixelFormat::kGrey12);
  EXPECT_EQ(layout(formats::YUYV), PixelFormat::kYuyv);
  EXPECT_EQ(layout(formats::YVYU), PixelFormat::kYuyv);
  EXPECT_EQ(layout(formats::UYVY), PixelFormat::kUyvy);
  EXPECT_EQ(layout(formats::VYUY), PixelFormat::kUyvy);
  for (const auto& planar : {formats::NV12, formats::NV21, formats::NV16, formats::NV61, formats::NV24, formats::NV42,
                             formats::YUV420, formats::YVU420, formats::YUV422, formats::YVU422})
    EXPECT_EQ(layout(planar), PixelFormat::kPlanarLuma) << planar.toString();
  for (const auto& bayer : {formats::SRGGB8, formats::SGRBG8, formats::SGBRG8, formats::SBGGR8})
    EXPECT_EQ(layout(bayer), PixelFormat::kBayer8) << bayer.toString();
}

TEST(FourccLayout, PackedGrey_IsKnownByItsModifier) {
  const uint64_t mipi = libcamera::formats::SRGGB10_CSI2P.modifier();
  EXPECT_EQ(layout_of(libcamera::formats::R10.fourcc(), mipi), PixelFormat::kGrey10Mipi);
  EXPECT_EQ(layout_of(libcamera::formats::R12.fourcc(), mipi), PixelFormat::kGrey12Mipi);
}

TEST(FourccLayout, OtherFormats_AreNone) {
  namespace formats = libcamera::formats;
  for (const auto& other : {formats::RGB888, formats::MJPEG, formats::SRGGB10, formats::SRGGB10_CSI2P})
    EXPECT_EQ(layout(other), PixelFormat::kCount) << other.toString();
}

}  // namespace
}  // namespace roomcal::drivers
