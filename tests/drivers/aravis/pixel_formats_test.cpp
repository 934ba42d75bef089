#include "drivers/aravis/pixel_formats.h"

#include <arv.h>
#include <gtest/gtest.h>

namespace roomcal::drivers {
namespace {

TEST(PfncFormat, Codes_AreThoseOfAravis) {
  EXPECT_EQ(pfnc_format("Mono8")->code, ARV_PIXEL_FORMAT_MONO_8);
  EXPECT_EQ(pfnc_format("Mono10")->code, ARV_PIXEL_FORMAT_MONO_10);
  EXPECT_EQ(pfnc_format("Mono12")->code, ARV_PIXEL_FORMAT_MONO_12);
  EXPECT_EQ(pfnc_format("Mono16")->code, ARV_PIXEL_FORMAT_MONO_16);
  EXPECT_EQ(pfnc_format("BayerGR8")->code, ARV_PIXEL_FORMAT_BAYER_GR_8);
  EXPECT_EQ(pfnc_format("BayerRG8")->code, ARV_PIXEL_FORMAT_BAYER_RG_8);
  EXPECT_EQ(pfnc_format("BayerGB8")->code, ARV_PIXEL_FORMAT_BAYER_GB_8);
  EXPECT_EQ(pfnc_format("BayerBG8")->code, ARV_PIXEL_FORMAT_BAYER_BG_8);
  EXPECT_EQ(pfnc_format("YUV422_8")->code, ARV_PIXEL_FORMAT_YUV_422_YUYV_PACKED);
  EXPECT_EQ(pfnc_format("YUV422_8_UYVY")->code, ARV_PIXEL_FORMAT_YUV_422_PACKED);
}

TEST(PfncFormat, BytesPerPixel_AreThoseInTheCode) {
  for (const char* name : {"Mono8", "Mono10", "Mono12", "Mono16", "BayerRG8", "YUV422_8", "YUV422Packed"}) {
    const PfncFormat* format = pfnc_format(name);
    EXPECT_EQ(static_cast<uint32_t>(format->bytes_per_px * 8), format->code >> 16U & 0xFFU) << name;
    EXPECT_EQ(luma_bytes(format->layout, 64, 48, 0), static_cast<std::size_t>(64 * 48 * format->bytes_per_px)) << name;
  }
}

TEST(PfncFormat, OtherFormats_AreNone) {
  for (const char* name : {"", "Mono12p", "Mono12Packed", "RGB8", "JPEG", "mono8"})
    EXPECT_EQ(pfnc_format(name), nullptr);
}

}  // namespace
}  // namespace roomcal::drivers
