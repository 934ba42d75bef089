#include "drivers/libcamera/fourcc_layout.h"

#include <algorithm>
#include <array>

namespace roomcal::drivers {

namespace {

constexpr uint32_t fourcc_of(const char (&text)[5]) {
  uint32_t code = 0;
  for (int i = 3; i >= 0; --i) code = code << 8U | static_cast<uint8_t>(text[i]);
  return code;
}

constexpr uint64_t kLinear = 0;
constexpr uint64_t kMipiPacked = uint64_t{0x0B} << 56U | 1;  // drm_fourcc.h: vendor MIPI, CSI-2 packed

struct Row {
  uint32_t fourcc;
  uint64_t modifier;
  PixelFormat layout;
};

// Numbers: Linux, include/uapi/drm/drm_fourcc.h; Bayer as libcamera's formats.yaml has it.
constexpr std::array<Row, 24> kRows = {{
    {fourcc_of("R8  "), kLinear, PixelFormat::kGrey8},
    {fourcc_of("R10 "), kLinear, PixelFormat::kGrey10},
    {fourcc_of("R12 "), kLinear, PixelFormat::kGrey12},
    {fourcc_of("R16 "), kLinear, PixelFormat::kGrey16},
    {fourcc_of("R10 "), kMipiPacked, PixelFormat::kGrey10Mipi},
    {fourcc_of("R12 "), kMipiPacked, PixelFormat::kGrey12Mipi},
    {fourcc_of("YUYV"), kLinear, PixelFormat::kYuyv},
    {fourcc_of("YVYU"), kLinear, PixelFormat::kYuyv},
    {fourcc_of("UYVY"), kLinear, PixelFormat::kUyvy},
    {fourcc_of("VYUY"), kLinear, PixelFormat::kUyvy},
    {fourcc_of("NV12"), kLinear, PixelFormat::kPlanarLuma},
    {fourcc_of("NV21"), kLinear, PixelFormat::kPlanarLuma},
    {fourcc_of("NV16"), kLinear, PixelFormat::kPlanarLuma},
    {fourcc_of("NV61"), kLinear, PixelFormat::kPlanarLuma},
    {fourcc_of("NV24"), kLinear, PixelFormat::kPlanarLuma},
    {fourcc_of("NV42"), kLinear, PixelFormat::kPlanarLuma},
    {fourcc_of("YU12"), kLinear, PixelFormat::kPlanarLuma},
    {fourcc_of("YV12"), kLinear, PixelFormat::kPlanarLuma},
    {fourcc_of("YU16"), kLinear, PixelFormat::kPlanarLuma},
    {fourcc_of("YV16"), kLinear, PixelFormat::kPlanarLuma},
    {fourcc_of("RGGB"), kLinear, PixelFormat::kBayer8},
    {fourcc_of("GRBG"), kLinear, PixelFormat::kBayer8},
    {fourcc_of("GBRG"), kLinear, PixelFormat::kBayer8},
    {fourcc_of("BA81"), kLinear, PixelFormat::kBayer8},
}};

}  // namespace

PixelFormat layout_of(uint32_t fourcc, uint64_t modifier) {
  const auto* row = std::find_if(kRows.begin(), kRows.end(), [&](const Row& candidate) {
    return candidate.fourcc == fourcc && candidate.modifier == modifier;
  });
  return row == kRows.end() ? PixelFormat::kCount : row->layout;
}

}  // namespace roomcal::drivers
