// libjpeg-turbo, given its memory, makes no heap call: for whole images, damaged ones, and ones it refuses.

#include <vector>

#include <gtest/gtest.h>

#include "drivers/image/mjpeg.h"
#include "tests/budget/heap_guard.h"
#include "tests/drivers/image/jpeg_writer.h"

namespace roomcal::drivers::test {
namespace {

TEST(MjpegHeap, EveryImage_NoCall) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer brings its own allocator";
#endif
  constexpr int kWidth = 640, kHeight = 480;
  std::vector<uint8_t> grey(kWidth * kHeight), out(grey.size());
  for (std::size_t i = 0; i < grey.size(); ++i) grey[i] = static_cast<uint8_t>(i / 7);
  const ImageView source(grey.data(), kWidth, kHeight);
  const MutableImageView into(out.data(), kWidth, kHeight);
  const std::vector<std::byte> colour = write_jpeg(source), bare = without_huffman_tables(colour);
  const std::vector<std::byte> progressive = write_jpeg(source, {.progressive = true});
  std::vector<std::byte> memory(MjpegDecoder::memory_bytes(kWidth));
  MjpegDecoder decoder;
  ASSERT_TRUE(decoder.open(memory).ok());
  std::size_t calls = 0;
  int whole = 0, refused = 0;
  {
    const budget::HeapGuard guard;
    for (int i = 0; i < 10; ++i) {
      whole += decoder.decode(colour, into).ok() && decoder.decode(bare, into).ok() ? 1 : 0;
      refused += decoder.decode(std::span(colour).first(colour.size() / 2), into).ok() ? 0 : 1;
      refused += decoder.decode(progressive, into).ok() ? 0 : 1;
    }
    calls = guard.calls();
  }
  EXPECT_EQ(calls, 0U);
  EXPECT_EQ(whole, 10);
  EXPECT_EQ(refused, 20);
}

}  // namespace
}  // namespace roomcal::drivers::test
