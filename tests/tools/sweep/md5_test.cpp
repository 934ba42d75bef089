#include "tools/sweep/md5.h"

#include <string>

#include <gtest/gtest.h>

namespace roomcal::tools {
namespace {

std::string md5(const std::string& text) { return md5_hex(std::as_bytes(std::span<const char>(text))); }

TEST(Md5, Rfc1321Suite_Matches) {
  EXPECT_EQ(md5(""), "d41d8cd98f00b204e9800998ecf8427e");
  EXPECT_EQ(md5("abc"), "900150983cd24fb0d6963f7d28e17f72");
  EXPECT_EQ(md5("12345678901234567890123456789012345678901234567890123456789012345678901234567890"),
            "57edf4a22be3c955ac49da2e2107b67a");
}

}  // namespace
}  // namespace roomcal::tools
