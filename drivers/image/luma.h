#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "runtime/base/span2d.h"
#include "runtime/base/status.h"

namespace roomcal::drivers {

/// How a camera lays out its pixels, as far as their luminance is concerned.
enum class PixelFormat : uint8_t {
  kGrey8,       ///< one byte
  kGrey10,      ///< two bytes, little-endian, low 10 bits (V4L2 Y10, PFNC Mono10)
  kGrey12,      ///< low 12 bits (Y12, Mono12)
  kGrey16,      ///< all 16 bits (Y16, Mono16)
  kGrey10Mipi,  ///< 4 pixels in 5 bytes: four high bytes, then the low bits (Y10P)
  kGrey12Mipi,  ///< 2 pixels in 3 bytes: two high bytes, then the low bits (Y12P)
  kYuyv,        ///< luminance in the even bytes
  kUyvy,        ///< luminance in the odd bytes
  kPlanarLuma,  ///< luminance first and whole, colour behind it: NV12, NV21, YU12, YV12, NV16, ...
  kBayer8,      ///< one byte, 2x2 pattern of one red, two green on a diagonal, one blue, in any order
  kMjpeg,       ///< compressed; not for to_luma(), see drivers/image/mjpeg.h
  kCount
};

/// "GREY", "Y10", ... as in profiles and messages. Never null; "unknown" for kCount.
const char* to_string(PixelFormat format);
/// @return kCount for a name that is none.
PixelFormat pixel_format_of(std::string_view name);

/// An image as a driver has it. Owns nothing.
struct RawImage {
  PixelFormat format = PixelFormat::kCount;
  int width_px = 0;
  int height_px = 0;
  std::size_t stride_bytes = 0;      ///< from one row's start to the next one's; 0: rows without padding
  std::span<const std::byte> bytes;  ///< as many as the driver has filled: there may be colour behind
};

/// Bytes that the luminance of such an image takes, padding after the last row excluded; 0 for kMjpeg, kCount, sizes
/// of no image, and a stride shorter than a row.
std::size_t luma_bytes(PixelFormat format, int width_px, int height_px, std::size_t stride_bytes);

/// Luminance of `raw` in 8 bits.
///
/// Deeper pixels lose their low bits. YUV keeps its range (16 to 235, mostly): contrast matters here, not level. A
/// Bayer pixel becomes the mean of the four 2x2 blocks that touch it, which are R/4 + G/2 + B/4 at every place of the
/// pattern:
///     out(x, y) = sum of raw(x + i, y + j) * w_i * w_j / 16,  i, j = -1, 0, 1,  w = 1, 2, 1
/// The kernel is symmetric, so edges and ring centres stay where they are (one 2x2 block alone would move them by half
/// a pixel), at the price of a blur of 0.71 px sigma. Beyond the border the pattern is mirrored at the border's pixels.
///
/// @param out  of the same size as `raw`.
/// @return kOk; kInvalidArgument if sizes differ or are none, or a Bayer image is not 2 x 2 at least; kCorrupt if there
///         are fewer bytes than luma_bytes(); kUnsupported for kMjpeg. Except for kOk `out` is untouched.
/// No heap; a few operations per pixel, for Bayer about 20.
Status to_luma(const RawImage& raw, MutableImageView out);

}  // namespace roomcal::drivers
