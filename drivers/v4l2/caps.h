#pragma once

#include <linux/videodev2.h>

#include "drivers/v4l2/handle.h"
#include "runtime/base/fixed_text.h"

namespace roomcal::drivers {

/// What an open node is.
struct CameraCaps {
  FixedText<31> card;
  FixedText<31> bus_info;
  bool delivers_images = false;  ///< captures video into memory that can be mapped
  bool multiplanar = false;      ///< by the multi-planar calls only
};

/// The node's own capabilities count, where its driver tells them apart from the whole device's: metadata nodes look
/// like cameras otherwise.
Trouble query_caps(const V4l2Handle& handle, CameraCaps& caps);

/// Whose buffers a camera of this kind delivers into.
constexpr uint32_t buffer_type(bool multiplanar) {
  return multiplanar ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
}

/// A kernel's text field: up to its first 0, or all of it.
template <std::size_t kSize>
std::string_view field_text(const unsigned char (&field)[kSize]) {
  std::size_t size = 0;
  while (size < kSize && field[size] != 0) ++size;
  return {reinterpret_cast<const char*>(field), size};
}

}  // namespace roomcal::drivers
