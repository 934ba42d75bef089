#include "drivers/replay/pgm.h"

#include <string>

#include <gtest/gtest.h>

namespace roomcal::drivers {
namespace {

Result<PgmHead> read(const std::string& text) { return read_pgm_head(std::as_bytes(std::span<const char>(text))); }

TEST(Pgm, EveryWayToWriteTheHead_IsRead) {
  for (const std::string head : {"P5\n640 480\n255\n", "P5 640 480 255 ", "P5\n# by hand\n640 # wide\n480\r\n255\n",
                                 "P5\t\v\f640\n#\n#\n480 255\n"}) {
    const Result<PgmHead> result = read(head + "pixels");
    ASSERT_TRUE(result.ok()) << head << result.status().detail();
    EXPECT_EQ(result.value().width_px, 640);
    EXPECT_EQ(result.value().height_px, 480);
    EXPECT_EQ(result.value().pixels_at, head.size());
  }
}

TEST(Pgm, PixelsThatLookLikeWhiteSpace_StayPixels) { EXPECT_EQ(read("P5 2 1 255\n\n\n").value().pixels_at, 11U); }

TEST(Pgm, OtherImages_AreNamed) {
  for (const std::string text : {"P2\n2 2\n255\n1 2 3 4", "P6\n2 2\n255\n", "\x89PNG\r\n", "", "P"})
    EXPECT_EQ(read(text).status().code(), StatusCode::kUnsupported) << text;
  EXPECT_EQ(read("P5\n2 2\n65535\n").status().code(), StatusCode::kUnsupported);
  EXPECT_EQ(read("P5\n2 2\n100\n").status().code(), StatusCode::kUnsupported);
}

TEST(Pgm, HeadWithoutSense_IsCorrupt) {
  for (const std::string text :
       {"P5", "P5\n", "P5\n0 2\n255\n", "P5\n-2 2\n255\n", "P5\n2\n", "P5\n2 x\n255\n", "P5\n2 2\n255",
        "P5\n99999999999999999999 2\n255\n", "P5\n65536 2\n255\n", "P5 # no end", "P5\n2 2\n255x"})
    EXPECT_EQ(read(text).status().code(), StatusCode::kCorrupt) << text;
  EXPECT_EQ(read("P5\n#" + std::string(kMaxPgmHead, 'c') + "\n2 2\n255\n").status().code(), StatusCode::kCorrupt);
}

}  // namespace
}  // namespace roomcal::drivers
