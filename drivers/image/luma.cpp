#include "drivers/image/luma.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace roomcal::drivers {

namespace {

struct FormatRow {
  PixelFormat format;
  const char* name;
  int pixels, bytes;  // so many pixels in so many bytes; a begun group is whole
};

constexpr auto kFormats = std::to_array<FormatRow>({
    {PixelFormat::kGrey8, "GREY", 1, 1},
    {PixelFormat::kGrey10, "Y10", 1, 2},
    {PixelFormat::kGrey12, "Y12", 1, 2},
    {PixelFormat::kGrey16, "Y16", 1, 2},
    {PixelFormat::kGrey10Mipi, "Y10P", 4, 5},
    {PixelFormat::kGrey12Mipi, "Y12P", 2, 3},
    {PixelFormat::kYuyv, "YUYV", 1, 2},
    {PixelFormat::kUyvy, "UYVY", 1, 2},
    {PixelFormat::kPlanarLuma, "NV12", 1, 1},
    {PixelFormat::kBayer8, "BAYER8", 1, 1},
    {PixelFormat::kMjpeg, "MJPEG", 0, 0},
});

constexpr bool in_order() {
  for (std::size_t i = 0; i < kFormats.size(); ++i)
    if (kFormats[i].format != static_cast<PixelFormat>(i)) return false;
  return kFormats.size() == static_cast<std::size_t>(PixelFormat::kCount);
}
static_assert(in_order(), "one row a format, in the order of PixelFormat");

const FormatRow* row_of(PixelFormat format) {
  const auto i = static_cast<std::size_t>(format);
  return i < kFormats.size() ? &kFormats[i] : nullptr;
}

std::size_t row_bytes(PixelFormat format, int width) {
  const FormatRow* row = row_of(format);
  if (row == nullptr || row->pixels == 0 || width <= 0) return 0;
  const auto pixels = static_cast<std::size_t>(row->pixels);
  return (static_cast<std::size_t>(width) + pixels - 1) / pixels * static_cast<std::size_t>(row->bytes);
}

struct Rows {
  const uint8_t* first;
  std::size_t stride;
  const uint8_t* operator[](int y) const { return first + static_cast<std::size_t>(y) * stride; }
};

template <int kStep, int kOffset>
void take_bytes(const uint8_t* in, uint8_t* out, int width) {
  for (int x = 0; x < width; ++x) out[x] = in[kStep * x + kOffset];
}

// Bits above the pixel's own are the driver's to leave; brighter than white is white.
template <int kShift>
void take_words(const uint8_t* in, uint8_t* out, int width) {
  for (int x = 0; x < width; ++x) {
    const int word = in[2 * x] | in[2 * x + 1] << 8;
    out[x] = static_cast<uint8_t>(std::min(word >> kShift, 255));
  }
}

template <int kPixels, int kBytes>
void take_groups(const uint8_t* in, uint8_t* out, int width) {
  for (int x = 0; x < width; ++x) out[x] = in[x / kPixels * kBytes + x % kPixels];
}

using TakeRow = void (*)(const uint8_t* in, uint8_t* out, int width);

TakeRow taker_of(PixelFormat format) {
  switch (format) {
    case PixelFormat::kGrey8:
    case PixelFormat::kPlanarLuma:
      return take_bytes<1, 0>;
    case PixelFormat::kYuyv:
      return take_bytes<2, 0>;
    case PixelFormat::kUyvy:
      return take_bytes<2, 1>;
    case PixelFormat::kGrey10:
      return take_words<2>;
    case PixelFormat::kGrey12:
      return take_words<4>;
    case PixelFormat::kGrey16:
      return take_words<8>;
    case PixelFormat::kGrey10Mipi:
      return take_groups<4, 5>;
    case PixelFormat::kGrey12Mipi:
      return take_groups<2, 3>;
    case PixelFormat::kBayer8:
    case PixelFormat::kMjpeg:
    case PixelFormat::kCount:
      break;
  }
  return nullptr;
}

// -1 becomes 1 and n becomes n - 2, which are of the same colour.
int mirrored(int i, int n) { return i < 0 ? 1 : i < n ? i : n - 2; }

// A strip of three rows with a column more on each side. Camera buffers may be memory without a cache, where a second
// look at a byte costs as much as the first: every byte is fetched once (but for the columns between strips).
class BayerStrip {
 public:
  static constexpr int kColumns = 1024;

  BayerStrip(const Rows& rows, int first, MutableImageView out)
      : rows_(rows), first_(first), columns_(std::min(kColumns, out.width() - first)), out_(out) {}

  void convert() {
    const int height = out_.height();
    fetch(mirrored(-1, height), lines_[0]);
    fetch(0, lines_[1]);
    for (int y = 0; y < height; ++y) {
      fetch(mirrored(y + 1, height), lines_[(y + 2) % 3]);
      blend(lines_[y % 3], lines_[(y + 1) % 3], lines_[(y + 2) % 3], out_.row(y) + first_);
    }
  }

 private:
  using Line = std::array<uint8_t, kColumns + 2>;

  void fetch(int y, Line& line) const {
    const uint8_t* row = rows_[y];
    line[0] = row[mirrored(first_ - 1, out_.width())];
    std::memcpy(line.data() + 1, row + first_, static_cast<std::size_t>(columns_));
    line[static_cast<std::size_t>(columns_) + 1] = row[mirrored(first_ + columns_, out_.width())];
  }

  void blend(const Line& above, const Line& own, const Line& below, uint8_t* out) const {
    const auto column = [&](int x) {
      const auto i = static_cast<std::size_t>(x);
      return above[i] + 2 * own[i] + below[i];
    };
    for (int x = 0; x < columns_; ++x)
      out[x] = static_cast<uint8_t>((column(x) + 2 * column(x + 1) + column(x + 2) + 8) >> 4);
  }

  const Rows& rows_;
  const int first_, columns_;
  const MutableImageView out_;
  std::array<Line, 3> lines_;
};

void bayer_to_luma(const Rows& rows, MutableImageView out) {
  for (int first = 0; first < out.width(); first += BayerStrip::kColumns) BayerStrip(rows, first, out).convert();
}

}  // namespace

const char* to_string(PixelFormat format) { return row_of(format) == nullptr ? "unknown" : row_of(format)->name; }

PixelFormat pixel_format_of(std::string_view name) {
  for (const FormatRow& row : kFormats)
    if (name == row.name) return row.format;
  return PixelFormat::kCount;
}

std::size_t luma_bytes(PixelFormat format, int width_px, int height_px, std::size_t stride_bytes) {
  const std::size_t row = row_bytes(format, width_px);
  if (row == 0 || height_px <= 0) return 0;
  if (stride_bytes == 0) stride_bytes = row;
  const auto before_last = static_cast<std::size_t>(height_px) - 1;
  if (stride_bytes < row || (before_last > 0 && stride_bytes > (SIZE_MAX - row) / before_last)) return 0;
  return before_last * stride_bytes + row;
}

Status to_luma(const RawImage& raw, MutableImageView out) {
  if (raw.format == PixelFormat::kMjpeg) return {StatusCode::kUnsupported, "a compressed image has no pixels yet"};
  const std::size_t needed = luma_bytes(raw.format, raw.width_px, raw.height_px, raw.stride_bytes);
  if (needed == 0) return {StatusCode::kInvalidArgument, "an image of no size, stride or format"};
  if (raw.width_px != out.width() || raw.height_px != out.height())
    return {StatusCode::kInvalidArgument, "the image's size is not the profile's"};
  const bool bayer = raw.format == PixelFormat::kBayer8;
  if (bayer && (raw.width_px < 2 || raw.height_px < 2))
    return {StatusCode::kInvalidArgument, "a Bayer image has 2 x 2 pixels at least"};
  if (raw.bytes.size() < needed) return {StatusCode::kCorrupt, "fewer bytes than the image has"};

  const Rows rows{reinterpret_cast<const uint8_t*>(raw.bytes.data()),
                  raw.stride_bytes != 0 ? raw.stride_bytes : row_bytes(raw.format, raw.width_px)};
  if (bayer) {
    bayer_to_luma(rows, out);
  } else {
    const TakeRow take = taker_of(raw.format);
    for (int y = 0; y < raw.height_px; ++y) take(rows[y], out.row(y), raw.width_px);
  }
  return ok_status();
}

}  // namespace roomcal::drivers
