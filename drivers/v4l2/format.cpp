#include "drivers/v4l2/format.h"

#include <array>

#include "drivers/image/mjpeg.h"
#include "drivers/v4l2/caps.h"

namespace roomcal::drivers {

using ports::ImageFault;

namespace {

struct Layout {
  uint32_t fourcc;
  PixelFormat format;
};

// In the order in which they are asked for.
constexpr auto kLayouts = std::to_array<Layout>({
    {V4L2_PIX_FMT_GREY, PixelFormat::kGrey8},         {V4L2_PIX_FMT_Y10, PixelFormat::kGrey10},
    {V4L2_PIX_FMT_Y12, PixelFormat::kGrey12},         {V4L2_PIX_FMT_Y16, PixelFormat::kGrey16},
    {V4L2_PIX_FMT_Y10P, PixelFormat::kGrey10Mipi},    {v4l2_fourcc('Y', '1', '2', 'P'), PixelFormat::kGrey12Mipi},
    {V4L2_PIX_FMT_YUYV, PixelFormat::kYuyv},          {V4L2_PIX_FMT_YVYU, PixelFormat::kYuyv},
    {V4L2_PIX_FMT_UYVY, PixelFormat::kUyvy},          {V4L2_PIX_FMT_VYUY, PixelFormat::kUyvy},
    {V4L2_PIX_FMT_NV12, PixelFormat::kPlanarLuma},    {V4L2_PIX_FMT_NV12M, PixelFormat::kPlanarLuma},
    {V4L2_PIX_FMT_NV21, PixelFormat::kPlanarLuma},    {V4L2_PIX_FMT_NV21M, PixelFormat::kPlanarLuma},
    {V4L2_PIX_FMT_NV16, PixelFormat::kPlanarLuma},    {V4L2_PIX_FMT_YUV420, PixelFormat::kPlanarLuma},
    {V4L2_PIX_FMT_YUV420M, PixelFormat::kPlanarLuma}, {V4L2_PIX_FMT_YVU420, PixelFormat::kPlanarLuma},
    {V4L2_PIX_FMT_YUV422P, PixelFormat::kPlanarLuma}, {V4L2_PIX_FMT_SRGGB8, PixelFormat::kBayer8},
    {V4L2_PIX_FMT_SGRBG8, PixelFormat::kBayer8},      {V4L2_PIX_FMT_SGBRG8, PixelFormat::kBayer8},
    {V4L2_PIX_FMT_SBGGR8, PixelFormat::kBayer8},      {V4L2_PIX_FMT_MJPEG, PixelFormat::kMjpeg},
    {V4L2_PIX_FMT_JPEG, PixelFormat::kMjpeg},
});

PixelFormat format_of(uint32_t fourcc) {
  for (const Layout& layout : kLayouts)
    if (layout.fourcc == fourcc) return layout.format;
  return PixelFormat::kCount;
}

bool is_multiplanar(const v4l2_format& raw) { return raw.type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE; }

CaptureFormat read(uint32_t fourcc, uint32_t field, uint32_t width, uint32_t height) {
  CaptureFormat format;
  format.fourcc = fourcc;
  format.format = field == V4L2_FIELD_NONE ? format_of(fourcc) : PixelFormat::kCount;
  format.width_px = static_cast<int>(width);
  format.height_px = static_cast<int>(height);
  return format;
}

}  // namespace

FormatCall::FormatCall(bool multiplanar) : raw_(zeroed<v4l2_format>()) { raw_.type = buffer_type(multiplanar); }

Trouble FormatCall::get(const V4l2Handle& handle) { return handle.call(V4l2Call::kSetFormat, VIDIOC_G_FMT, raw_); }
Trouble FormatCall::set(const V4l2Handle& handle) { return handle.call(V4l2Call::kSetFormat, VIDIOC_S_FMT, raw_); }

void FormatCall::ask(uint32_t fourcc, int width_px, int height_px) {
  const auto fill = [&](auto& pixels) {
    pixels.pixelformat = fourcc;
    pixels.width = static_cast<uint32_t>(width_px);
    pixels.height = static_cast<uint32_t>(height_px);
    pixels.field = V4L2_FIELD_NONE;
  };
  *this = FormatCall(is_multiplanar(raw_));
  if (is_multiplanar(raw_)) {
    fill(raw_.fmt.pix_mp);
  } else {
    fill(raw_.fmt.pix);
  }
}

CaptureFormat FormatCall::answer() const {
  CaptureFormat format;
  if (is_multiplanar(raw_)) {
    const v4l2_pix_format_mplane& pixels = raw_.fmt.pix_mp;
    format = read(pixels.pixelformat, pixels.field, pixels.width, pixels.height);
    format.stride_bytes = pixels.plane_fmt[0].bytesperline;
    format.buffer_bytes = pixels.plane_fmt[0].sizeimage;
  } else {
    const v4l2_pix_format& pixels = raw_.fmt.pix;
    format = read(pixels.pixelformat, pixels.field, pixels.width, pixels.height);
    format.stride_bytes = pixels.bytesperline;
    format.buffer_bytes = pixels.sizeimage;
  }
  return format;
}

namespace {

// Whether an image of what the driver answered is what the profile wants, and fits the driver's own buffers.
bool usable(const CaptureFormat& got, const V4l2Options& options, PixelFormat wanted) {
  if (got.format != wanted || got.width_px != options.width_px || got.height_px != options.height_px) return false;
  if (wanted == PixelFormat::kMjpeg) return MjpegDecoder::kBuiltIn && got.buffer_bytes > 0;
  const std::size_t needed = luma_bytes(got.format, got.width_px, got.height_px, got.stride_bytes);
  return needed != 0 && needed <= got.buffer_bytes;
}

}  // namespace

Trouble set_format(const V4l2Handle& handle, bool multiplanar, const V4l2Options& options, CaptureFormat& got) {
  for (const PixelFormat wanted : options.formats) {
    for (const Layout& layout : kLayouts) {
      if (layout.format != wanted) continue;
      FormatCall call(multiplanar);
      call.ask(layout.fourcc, options.width_px, options.height_px);
      const Trouble trouble = call.set(handle);
      if (!trouble.none() && trouble.fault != ImageFault::kFormat) return trouble;
      if (!trouble.none()) continue;
      got = call.answer();
      if (usable(got, options, wanted)) return {};
    }
  }
  return {ImageFault::kFormat, 0};
}

FixedText<4> fourcc_text(uint32_t fourcc) {
  FixedText<4> text;
  for (int i = 0; i < 4; ++i) {
    const auto c = static_cast<char>(fourcc >> (8 * i) & 0x7f);
    if (c != ' ') text.append({c < ' ' ? "?" : &c, 1});
  }
  return text;
}

}  // namespace roomcal::drivers
