#include "drivers/aravis/pixel_formats.h"

#include <algorithm>
#include <array>

namespace roomcal::drivers {

namespace {

// Codes: GenICam PFNC values, EMVA.
constexpr std::array<PfncFormat, 12> kFormats = {{
    {"Mono8", 0x01080001, PixelFormat::kGrey8, 1},
    {"Mono10", 0x01100003, PixelFormat::kGrey10, 2},
    {"Mono12", 0x01100005, PixelFormat::kGrey12, 2},
    {"Mono16", 0x01100007, PixelFormat::kGrey16, 2},
    {"BayerGR8", 0x01080008, PixelFormat::kBayer8, 1},
    {"BayerRG8", 0x01080009, PixelFormat::kBayer8, 1},
    {"BayerGB8", 0x0108000A, PixelFormat::kBayer8, 1},
    {"BayerBG8", 0x0108000B, PixelFormat::kBayer8, 1},
    {"YUV422_8", 0x02100032, PixelFormat::kYuyv, 2},
    {"YUV422_8_UYVY", 0x0210001F, PixelFormat::kUyvy, 2},
    {"YUV422Packed", 0x0210001F, PixelFormat::kUyvy, 2},
    {"YUYVPacked", 0x02100032, PixelFormat::kYuyv, 2},
}};

}  // namespace

const PfncFormat* pfnc_format(std::string_view name) {
  const auto* found =
      std::find_if(kFormats.begin(), kFormats.end(), [&](const PfncFormat& format) { return name == format.name; });
  return found == kFormats.end() ? nullptr : found;
}

}  // namespace roomcal::drivers
