#include <vector>

#include <gtest/gtest.h>

#include "drivers/image/mjpeg.h"

namespace roomcal::drivers {
namespace {

TEST(Mjpeg, BuildWithout_SaysSo) {
  EXPECT_FALSE(MjpegDecoder::kBuiltIn);
  MjpegDecoder decoder;
  EXPECT_EQ(decoder.open({}).code(), StatusCode::kUnsupported);
  EXPECT_EQ(decoder.decode({}, {}).code(), StatusCode::kUnavailable);
}

}  // namespace
}  // namespace roomcal::drivers
