#pragma once

#include <cstddef>
#include <cstdint>

#include <linux/videodev2.h>

#include "drivers/image/luma.h"
#include "drivers/v4l2/handle.h"
#include "drivers/v4l2/options.h"

namespace roomcal::drivers {

/// How the camera's images lie in its buffers, by its own word.
struct CaptureFormat {
  PixelFormat format = PixelFormat::kCount;
  uint32_t fourcc = 0;
  int width_px = 0;
  int height_px = 0;
  std::size_t stride_bytes = 0;
  std::size_t buffer_bytes = 0;
};

/// A v4l2_format by names that do not depend on its being single- or multi-planar; of several planes the first, which
/// has the luminance.
class FormatCall {
 public:
  explicit FormatCall(bool multiplanar);

  Trouble get(const V4l2Handle& handle);
  /// The driver changes what it cannot do, and says so in `format()`.
  Trouble set(const V4l2Handle& handle);
  void ask(uint32_t fourcc, int width_px, int height_px);
  /// @return what the driver answered; `format` is kCount for a layout that we do not read, and for interlaced images,
  ///         which are two half images of different times.
  CaptureFormat answer() const;

 private:
  v4l2_format raw_;
};

/// Asks for the options' formats one after the other until the driver's answer is what was asked for.
/// @param[out] got  the last answer, also if it was none of them.
/// @return none; kFormat if none of them is delivered at this size.
Trouble set_format(const V4l2Handle& handle, bool multiplanar, const V4l2Options& options, CaptureFormat& got);

/// "GREY" for a fourcc.
FixedText<4> fourcc_text(uint32_t fourcc);

}  // namespace roomcal::drivers
