#include "runtime/base/span2d.h"

#include <array>

#include <gtest/gtest.h>

namespace roomcal {
namespace {

TEST(Span2D, Stride_SeparatesRows) {
  std::array<uint8_t, 12> bytes{};
  MutableImageView image(bytes.data(), 3, 3, 4);
  image(2, 1) = 7;
  EXPECT_EQ(bytes[6], 7);
  const ImageView read_only = image;
  EXPECT_EQ(read_only.row(1)[2], 7);
}

}  // namespace
}  // namespace roomcal
