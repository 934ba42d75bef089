#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "drivers/image/luma.h"

namespace roomcal::drivers {

/// A pixel format of GenICam's naming convention (PFNC) that we read.
struct PfncFormat {
  const char* name;    ///< as cameras call it
  uint32_t code;       ///< as images carry it
  PixelFormat layout;  ///< as to_luma() takes it
  int bytes_per_px;
};

/// Mono8, Mono10, Mono12, Mono16, BayerXX8 in all orders, YUV422_8, YUV422_8_UYVY and YUV422Packed.
/// @return null for any other: formats packed across bytes and compressed ones, of which cameras offer Mono8 as well.
const PfncFormat* pfnc_format(std::string_view name);

}  // namespace roomcal::drivers
