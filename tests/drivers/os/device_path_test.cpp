#include "drivers/os/device_path.h"

#include <string>

#include <gtest/gtest.h>

namespace roomcal::drivers {
namespace {

TEST(DevicePath, AbsentOrCut_IsRefused) {
  EXPECT_TRUE(check_path("/dev/watchdog0").ok());
  EXPECT_EQ(check_path("").code(), StatusCode::kInvalidArgument);
  EXPECT_TRUE(check_path(std::string_view(std::string(126, 'x'))).ok());
  EXPECT_EQ(check_path(std::string_view(std::string(127, 'x'))).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(check_path(std::string_view(std::string(1000, 'x'))).code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace roomcal::drivers
