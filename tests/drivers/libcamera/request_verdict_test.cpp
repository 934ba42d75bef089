#include "drivers/libcamera/request_verdict.h"

#include <gtest/gtest.h>

namespace roomcal::drivers {
namespace {

using libcamera::FrameMetadata;
using libcamera::Request;

TEST(RequestVerdict, CompleteRequest_IsAsItsFrame) {
  EXPECT_EQ(verdict_of(Request::RequestComplete, FrameMetadata::FrameSuccess), RequestVerdict::kWhole);
  EXPECT_EQ(verdict_of(Request::RequestComplete, FrameMetadata::FrameError), RequestVerdict::kDamaged);
  EXPECT_EQ(verdict_of(Request::RequestComplete, FrameMetadata::FrameCancelled), RequestVerdict::kCancelled);
}

TEST(RequestVerdict, CancelledRequest_IsCancelledWhateverItsFrame) {
  EXPECT_EQ(verdict_of(Request::RequestCancelled, FrameMetadata::FrameSuccess), RequestVerdict::kCancelled);
  EXPECT_EQ(verdict_of(Request::RequestCancelled, FrameMetadata::FrameError), RequestVerdict::kCancelled);
}

template <typename Status>
void expect_startup_skipped() {
  if constexpr (requires { Status::FrameStartup; })
    EXPECT_EQ(verdict_of(Request::RequestComplete, Status::FrameStartup), RequestVerdict::kSkip);
  else
    GTEST_SKIP() << "this libcamera does not tell a sensor's first images from the others";
}

TEST(RequestVerdict, SensorsFirstImages_AreSkipped) { expect_startup_skipped<FrameMetadata::Status>(); }

}  // namespace
}  // namespace roomcal::drivers
