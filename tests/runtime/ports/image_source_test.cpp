#include "runtime/ports/image_source.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

namespace roomcal::ports {
namespace {

TEST(ImageFault, EveryOne_HasItsOwnNameAndARemedy) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < kImageFaults; ++i) {
    const auto fault = static_cast<ImageFault>(i);
    EXPECT_TRUE(names.insert(to_string(fault)).second) << to_string(fault);
    EXPECT_GT(std::string(remedy(fault)).size(), 10U) << to_string(fault);
  }
  EXPECT_STREQ(to_string(ImageFault::kCount), "none");
}

TEST(SourceState, EveryOne_HasItsOwnName) {
  std::set<std::string> names;
  for (int i = 0; i < 4; ++i) names.insert(to_string(static_cast<SourceState>(i)));
  EXPECT_EQ(names.size(), 4U);
  EXPECT_EQ(names.count("unknown"), 0U);
}

}  // namespace
}  // namespace roomcal::ports
