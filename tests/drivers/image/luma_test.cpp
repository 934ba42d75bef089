#include "drivers/image/luma.h"

#include <cmath>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/marker/detector.h"
#include "tests/truth/marker_patch.h"

namespace roomcal::drivers {
namespace {

constexpr int kFormatCount = static_cast<int>(PixelFormat::kCount);

std::vector<PixelFormat> raw_formats() {
  std::vector<PixelFormat> all;
  for (int i = 0; i < kFormatCount; ++i)
    if (static_cast<PixelFormat>(i) != PixelFormat::kMjpeg) all.push_back(static_cast<PixelFormat>(i));
  return all;
}

// Writes `grey` as a driver would; the low bits and the colour hold anything.
void put(PixelFormat format, int x, int grey, int noise, std::byte* row) {
  const auto byte = [row](int i, int value) { row[i] = static_cast<std::byte>(value); };
  const auto word = [&](int bits) {
    const int value = grey << (bits - 8) | (noise & ((1 << (bits - 8)) - 1));
    byte(2 * x, value & 0xff);
    byte(2 * x + 1, value >> 8);
  };
  switch (format) {
    case PixelFormat::kGrey10:
      return word(10);
    case PixelFormat::kGrey12:
      return word(12);
    case PixelFormat::kGrey16:
      return word(16);
    case PixelFormat::kGrey10Mipi:
      byte(x / 4 * 5 + x % 4, grey);
      return byte(x / 4 * 5 + 4, noise);
    case PixelFormat::kGrey12Mipi:
      byte(x / 2 * 3 + x % 2, grey);
      return byte(x / 2 * 3 + 2, noise);
    case PixelFormat::kYuyv:
      byte(2 * x, grey);
      return byte(2 * x + 1, noise);
    case PixelFormat::kUyvy:
      byte(2 * x + 1, grey);
      return byte(2 * x, noise);
    default:
      byte(x, grey);
  }
}

struct Case {
  PixelFormat format;
  int width, height;
  std::size_t padding;
};

void expect_the_same_grey(const Case& c) {
  const std::size_t row = luma_bytes(c.format, c.width, 1, 0), stride = row + c.padding;
  ASSERT_GT(row, 0U);
  std::mt19937 random(7);
  std::vector<std::byte> bytes(luma_bytes(c.format, c.width, c.height, stride));  // not one byte more
  std::vector<uint8_t> grey(static_cast<std::size_t>(c.width * c.height));
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; ++x) {
      const int value = static_cast<int>(random() % 256);
      grey[static_cast<std::size_t>(y * c.width + x)] = static_cast<uint8_t>(value);
      put(c.format, x, value, static_cast<int>(random() % 256), bytes.data() + static_cast<std::size_t>(y) * stride);
    }
  std::vector<uint8_t> out(grey.size());
  ASSERT_TRUE(to_luma({c.format, c.width, c.height, stride, bytes}, {out.data(), c.width, c.height}).ok());
  EXPECT_EQ(out, grey) << to_string(c.format) << " " << c.width << "x" << c.height << "+" << c.padding;
}

TEST(Luma, EveryFormatButBayer_GivesTheHighBits) {
  for (const PixelFormat format : raw_formats()) {
    if (format == PixelFormat::kBayer8) continue;
    for (const int width : {1, 2, 3, 4, 5, 64, 641})
      for (const std::size_t padding : {0U, 1U, 64U}) expect_the_same_grey({format, width, 3, padding});
  }
}

TEST(Luma, BitsAboveThePixels_AreWhite) {
  const std::vector<std::byte> bytes(2, std::byte{0xff});
  for (const PixelFormat format : {PixelFormat::kGrey10, PixelFormat::kGrey12, PixelFormat::kGrey16}) {
    uint8_t out = 0;
    ASSERT_TRUE(to_luma({format, 1, 1, 0, bytes}, {&out, 1, 1}).ok());
    EXPECT_EQ(out, 255);
  }
}

TEST(Luma, OneByteShort_IsRefusedAndNothingWritten) {
  for (const PixelFormat format : raw_formats()) {
    const std::size_t needed = luma_bytes(format, 8, 4, 100);
    const std::vector<std::byte> bytes(needed - 1, std::byte{1});
    std::vector<uint8_t> out(32, 77);
    EXPECT_EQ(to_luma({format, 8, 4, 100, bytes}, {out.data(), 8, 4}).code(), StatusCode::kCorrupt);
    EXPECT_EQ(out, std::vector<uint8_t>(32, 77));
  }
}

TEST(Luma, SizesOfNoImage_AreRefused) {
  const std::vector<std::byte> bytes(10000);
  std::vector<uint8_t> out(64);
  const MutableImageView into(out.data(), 8, 8);
  const auto code = [&](PixelFormat format, int width, int height, std::size_t stride) {
    return to_luma({format, width, height, stride, bytes}, into).code();
  };
  EXPECT_EQ(code(PixelFormat::kGrey8, 0, 8, 0), StatusCode::kInvalidArgument);
  EXPECT_EQ(code(PixelFormat::kGrey8, 8, -1, 0), StatusCode::kInvalidArgument);
  EXPECT_EQ(code(PixelFormat::kGrey8, 8, 8, 7), StatusCode::kInvalidArgument);
  EXPECT_EQ(code(PixelFormat::kGrey8, 9, 8, 0), StatusCode::kInvalidArgument);
  EXPECT_EQ(code(PixelFormat::kGrey8, 8, 7, 0), StatusCode::kInvalidArgument);
  EXPECT_EQ(code(PixelFormat::kYuyv, 8, 8, SIZE_MAX / 2), StatusCode::kInvalidArgument);
  EXPECT_EQ(code(PixelFormat::kCount, 8, 8, 0), StatusCode::kInvalidArgument);
  EXPECT_EQ(code(static_cast<PixelFormat>(200), 8, 8, 0), StatusCode::kInvalidArgument);
  EXPECT_EQ(code(PixelFormat::kMjpeg, 8, 8, 0), StatusCode::kUnsupported);
  EXPECT_EQ(to_luma({PixelFormat::kBayer8, 1, 8, 0, bytes}, {out.data(), 1, 8}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(to_luma({PixelFormat::kBayer8, 8, 1, 0, bytes}, {out.data(), 8, 1}).code(), StatusCode::kInvalidArgument);
}

// A colour sensor sees a grey sheet under coloured light: its red, green and blue pixels differ in gain only.
std::vector<std::byte> mosaic(const std::vector<double>& clean, int width, int phase_x, int phase_y, double red,
                              double blue) {
  std::vector<std::byte> bytes(clean.size());
  for (std::size_t i = 0; i < clean.size(); ++i) {
    const auto at = static_cast<int>(i);
    const int px = (at % width + phase_x) % 2, py = (at / width + phase_y) % 2;
    const double gain = px != py ? 1 : px == 0 ? red : blue;
    bytes[i] = static_cast<std::byte>(std::lround(std::min(clean[i] * gain, 255.0)));
  }
  return bytes;
}

// The formula of the header, pixel by pixel.
uint8_t blended(const std::vector<std::byte>& raw, int width, int height, int x, int y) {
  const auto mirrored = [](int i, int n) { return i < 0 ? -i : i < n ? i : 2 * n - 2 - i; };
  int sum = 0;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      const int at = mirrored(y + j, height) * width + mirrored(x + i, width);
      sum += std::to_integer<int>(raw[static_cast<std::size_t>(at)]) * (2 - i * i) * (2 - j * j);
    }
  return static_cast<uint8_t>((sum + 8) / 16);
}

TEST(Luma, BayerOfAnySize_IsTheFormulaOfTheHeader) {
  std::mt19937 random(3);
  for (const int width : {2, 3, 1023, 1024, 1025, 1026, 2049}) {
    for (const int height : {2, 3, 5}) {
      std::vector<std::byte> raw(static_cast<std::size_t>(width * height));
      for (std::byte& pixel : raw) pixel = static_cast<std::byte>(random() % 256);
      std::vector<uint8_t> out(raw.size()), expected(raw.size());
      ASSERT_TRUE(to_luma({PixelFormat::kBayer8, width, height, 0, raw}, {out.data(), width, height}).ok());
      for (int i = 0; i < width * height; ++i)
        expected[static_cast<std::size_t>(i)] = blended(raw, width, height, i % width, i / width);
      EXPECT_EQ(out, expected) << width << "x" << height;
    }
  }
}

TEST(Luma, BayerOfUniformColour_IsUniformToTheBorderAtEveryPhase) {
  const std::vector<double> clean(9 * 7, 200);
  for (int phase = 0; phase < 4; ++phase) {
    const std::vector<std::byte> bytes = mosaic(clean, 9, phase % 2, phase / 2, 0.5, 0.25);
    std::vector<uint8_t> out(clean.size());
    ASSERT_TRUE(to_luma({PixelFormat::kBayer8, 9, 7, 0, bytes}, {out.data(), 9, 7}).ok());
    for (const uint8_t grey : out) EXPECT_EQ(grey, 138);  // 100 / 4 + 200 / 2 + 50 / 4, rounded
  }
}

TEST(Luma, BayerOfAnEdge_LeavesItWhereItIs) {
  constexpr int kWidth = 64;
  for (int phase = 0; phase < 4; ++phase) {
    for (const double edge_px : {30.0, 30.25, 30.5, 31.0}) {
      std::vector<double> clean(kWidth * 4);
      for (std::size_t i = 0; i < clean.size(); ++i) {
        const double x = static_cast<double>(i % kWidth);
        clean[i] =
            40 + 160 * std::clamp((x + 1 - edge_px) / 2, 0.0, 1.0);  // as wide as the pattern, so it has no alias
      }
      const std::vector<std::byte> bytes = mosaic(clean, kWidth, phase % 2, phase / 2, 0.6, 0.4);
      std::vector<uint8_t> out(clean.size());
      ASSERT_TRUE(to_luma({PixelFormat::kBayer8, kWidth, 4, 0, bytes}, {out.data(), kWidth, 4}).ok());
      // Where a step lies follows from the sum over it: as many pixels are dark as lie before it. Rows in pairs,
      // because two phases of colour follow each other.
      double dark = 0, bright = 0, sum = 0;
      for (int y = 0; y < 2; ++y) {
        dark += out[static_cast<std::size_t>(y * kWidth + 5)];
        bright += out[static_cast<std::size_t>(y * kWidth + kWidth - 6)];
        for (int x = 0; x < kWidth; ++x) sum += out[static_cast<std::size_t>(y * kWidth + x)];
      }
      const double found_px = (kWidth * bright - sum) / (bright - dark) - 0.5;
      EXPECT_NEAR(found_px, edge_px, 0.02) << "phase " << phase;
    }
  }
}

TEST(Luma, BayerOfARing_LeavesItsCentreWhereTheDetectorFindsItInGrey) {
  for (int phase = 0; phase < 4; ++phase) {
    truth::MarkerPatch patch;
    patch.H_px_plane = truth::marker_homography({80.3, 79.6}, 60, 0.5, 0.4 * phase, 0.1, 900);
    patch.noise_grey = 0;
    const std::vector<double> clean = truth::render_clean(patch);
    const std::vector<std::byte> bytes = mosaic(clean, patch.width, phase % 2, phase / 2, 0.6, 0.4);
    std::vector<uint8_t> luma(clean.size());
    ASSERT_TRUE(
        to_luma({PixelFormat::kBayer8, patch.width, patch.height, 0, bytes}, {luma.data(), patch.width, patch.height})
            .ok());
    std::vector<std::byte> memory(marker::detector_scratch_bytes(patch.width, patch.height));
    Arena arena{std::span<std::byte>(memory)};
    std::vector<marker::Detection> found(4);
    std::size_t count = 0;
    ASSERT_TRUE(marker::detect(truth::view(patch, luma), {}, arena, found, count).ok());
    ASSERT_EQ(count, 1U);
    EXPECT_EQ(found[0].status, marker::DetectionStatus::kOk);
    EXPECT_LT((found[0].centre_px - patch.centre_px()).norm(), 0.02) << "phase " << phase;
  }
}

TEST(PixelFormat, EveryOne_IsFoundByItsName) {
  std::set<std::string> names;
  for (int i = 0; i < kFormatCount; ++i) {
    const auto format = static_cast<PixelFormat>(i);
    EXPECT_TRUE(names.insert(to_string(format)).second);
    EXPECT_EQ(pixel_format_of(to_string(format)), format);
  }
  EXPECT_STREQ(to_string(PixelFormat::kCount), "unknown");
  EXPECT_EQ(pixel_format_of("H264"), PixelFormat::kCount);
}

}  // namespace
}  // namespace roomcal::drivers
