#include "drivers/image/start_status.h"

#include <string>

#include <gtest/gtest.h>

namespace roomcal::drivers {
namespace {

using ports::ImageFault;

TEST(StartStatus, EveryFault_HasACodeThatThePortAllowsAndARemedy) {
  EXPECT_TRUE(start_status(ImageFault::kCount).ok());
  for (std::size_t i = 0; i < ports::kImageFaults; ++i) {
    const Status status = start_status(static_cast<ImageFault>(i));
    EXPECT_TRUE(status.code() == StatusCode::kNotFound || status.code() == StatusCode::kUnavailable ||
                status.code() == StatusCode::kUnsupported);
    EXPECT_NE(std::string(status.detail()).find(';'), std::string::npos) << status.detail();
  }
  EXPECT_EQ(start_status(ImageFault::kNotFound).code(), StatusCode::kNotFound);
  EXPECT_EQ(start_status(ImageFault::kFormat).code(), StatusCode::kUnsupported);
  EXPECT_EQ(start_status(ImageFault::kBusy).code(), StatusCode::kUnavailable);
}

}  // namespace
}  // namespace roomcal::drivers
