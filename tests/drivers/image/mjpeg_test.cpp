#include "drivers/image/mjpeg.h"

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/marker/detector.h"
#include "tests/drivers/image/jpeg_writer.h"
#include "tests/truth/marker_patch.h"

namespace roomcal::drivers::test {
namespace {

// Soft enough for JPEG to keep, with every level in it.
std::vector<uint8_t> waves(int width, int height) {
  std::vector<uint8_t> pixels(static_cast<std::size_t>(width * height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      pixels[static_cast<std::size_t>(y * width + x)] =
          static_cast<uint8_t>(128 + 100 * std::sin(x * 0.05) * std::cos(y * 0.07));
  return pixels;
}

class Mjpeg : public testing::Test {
 protected:
  static constexpr int kWidth = 328, kHeight = 240;

  Mjpeg() { EXPECT_TRUE(decoder.open(memory).ok()); }

  MutableImageView view() { return {out.data(), kWidth, kHeight}; }
  Status decode(const std::vector<std::byte>& jpeg) { return decoder.decode(jpeg, view()); }
  int worst_error() const {
    int worst = 0;
    for (std::size_t i = 0; i < out.size(); ++i) worst = std::max(worst, std::abs(out[i] - grey[i]));
    return worst;
  }

  std::vector<std::byte> memory = std::vector<std::byte>(MjpegDecoder::memory_bytes(kWidth));
  std::vector<uint8_t> grey = waves(kWidth, kHeight), out = std::vector<uint8_t>(grey.size());
  ImageView source{grey.data(), kWidth, kHeight};
  MjpegDecoder decoder;
};

TEST_F(Mjpeg, EveryKindThatCamerasSend_GivesItsLuminance) {
  const std::vector<std::byte> colour = write_jpeg(source);
  std::vector<std::byte> padded = colour;
  padded.resize(padded.size() + 5000);  // a driver that counts its whole buffer as filled
  for (const std::vector<std::byte>& jpeg :
       {colour, write_jpeg(source, {.colour = false}), write_jpeg(source, {.restart_rows = 1}),
        without_huffman_tables(colour), padded}) {
    out.assign(out.size(), 0);
    const Status decoded = decode(jpeg);
    ASSERT_TRUE(decoded.ok()) << decoded.detail();
    EXPECT_LE(worst_error(), 4);
  }
}

TEST_F(Mjpeg, CutAnywhere_IsCorruptAndTheNextImageIsFine) {
  const std::vector<std::byte> jpeg = write_jpeg(source);
  for (std::size_t size = 0; size < jpeg.size(); size += size < 700 ? 1 : 101) {
    const std::vector<std::byte> cut(jpeg.begin(), jpeg.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_EQ(decode(cut).code(), StatusCode::kCorrupt) << size;
  }
  ASSERT_TRUE(decode(jpeg).ok());
  EXPECT_LE(worst_error(), 4);
}

TEST_F(Mjpeg, AnyByteChanged_HasAnAnswerAndLeavesNoTrace) {
  const std::vector<std::byte> jpeg = write_jpeg(source);
  std::mt19937 random(11);
  int refused = 0;
  for (int i = 0; i < 3000; ++i) {
    std::vector<std::byte> spoilt = jpeg;
    for (int n = 0; n < 1 + i % 4; ++n)
      spoilt[random() % (i % 2 == 0 ? 650 : spoilt.size())] = static_cast<std::byte>(random());
    if (!decode(spoilt).ok()) ++refused;
  }
  EXPECT_GT(refused, 1000);
  ASSERT_TRUE(decode(without_huffman_tables(jpeg)).ok());  // no table of a damaged image is left
  EXPECT_LE(worst_error(), 4);
}

TEST_F(Mjpeg, Noise_IsCorrupt) {
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) {
    std::vector<std::byte> noise(random() % 3000);
    for (std::byte& byte : noise) byte = static_cast<std::byte>(random());
    EXPECT_EQ(decode(noise).code(), StatusCode::kCorrupt);
  }
}

TEST_F(Mjpeg, AnotherSizeOrProgressive_IsSaid) {
  const std::vector<uint8_t> small = waves(64, 64);
  EXPECT_EQ(decode(write_jpeg({small.data(), 64, 64})).code(), StatusCode::kInvalidArgument);
  const Status progressive = decode(write_jpeg(source, {.progressive = true}));
  EXPECT_EQ(progressive.code(), StatusCode::kUnsupported);
  EXPECT_NE(std::string(progressive.detail()).find("progressive"), std::string::npos);
  EXPECT_TRUE(decode(write_jpeg(source)).ok());
}

TEST_F(Mjpeg, LittleMemory_IsAStatus) {
  MjpegDecoder small;
  EXPECT_EQ(small.open(std::span(memory).first(1000)).code(), StatusCode::kOutOfMemory);
  EXPECT_EQ(small.decode(write_jpeg(source), view()).code(), StatusCode::kUnavailable);
  MjpegDecoder narrow;  // set aside for a narrower image
  std::vector<std::byte> some(MjpegDecoder::memory_bytes(8));
  ASSERT_TRUE(narrow.open(some).ok());
  const std::vector<uint8_t> wide = waves(8000, 16);
  std::vector<uint8_t> into(wide.size());
  EXPECT_EQ(narrow.decode(write_jpeg({wide.data(), 8000, 16}), {into.data(), 8000, 16}).code(),
            StatusCode::kOutOfMemory);
}

TEST_F(Mjpeg, EveryWidth_HasMemoryEnough) {
  for (const int width : {16, 17, 640, 1280, 1920, 4096, 8192}) {
    const std::vector<uint8_t> pixels = waves(width, 32);
    const ImageView wide(pixels.data(), width, 32);
    std::vector<std::byte> block(MjpegDecoder::memory_bytes(width));
    std::vector<uint8_t> into(pixels.size());
    MjpegDecoder wide_decoder;
    ASSERT_TRUE(wide_decoder.open(block).ok());
    for (const JpegOptions& options :
         {JpegOptions{}, JpegOptions{.colour = false}, JpegOptions{.restart_rows = 1},
          JpegOptions{.chroma_x = 1, .chroma_y = 1}, JpegOptions{.chroma_x = 2, .chroma_y = 1},
          JpegOptions{.chroma_x = 4, .chroma_y = 1}, JpegOptions{.chroma_x = 1, .chroma_y = 2},
          JpegOptions{.chroma_x = 4, .chroma_y = 2}})
      for (int i = 0; i < 3; ++i)
        EXPECT_TRUE(wide_decoder.decode(write_jpeg(wide, options), {into.data(), width, 32}).ok())
            << width << " " << options.chroma_x << "x" << options.chroma_y;
  }
}

TEST_F(Mjpeg, RingOfACompressedImage_StaysWhereItIs) {
  truth::MarkerPatch patch;
  patch.H_px_plane = truth::marker_homography({80.3, 79.6}, 60, 0.5, 0.4, 0.1, 900);
  const std::vector<uint8_t> rendered = truth::render(patch);
  const std::vector<std::byte> jpeg = write_jpeg(truth::view(patch, rendered), {.quality = 95});
  std::vector<uint8_t> decoded(rendered.size());
  ASSERT_TRUE(decoder.decode(jpeg, {decoded.data(), patch.width, patch.height}).ok());
  std::vector<std::byte> scratch(marker::detector_scratch_bytes(patch.width, patch.height));
  Arena arena{std::span<std::byte>(scratch)};
  std::vector<marker::Detection> found(4);
  std::size_t count = 0;
  ASSERT_TRUE(marker::detect(truth::view(patch, decoded), {}, arena, found, count).ok());
  ASSERT_EQ(count, 1U);
  EXPECT_LT((found[0].centre_px - patch.centre_px()).norm(), 0.05);
}

}  // namespace
}  // namespace roomcal::drivers::test
