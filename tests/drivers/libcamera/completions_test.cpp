#include "drivers/libcamera/completions.h"

#include <gtest/gtest.h>

#include "tests/fakes/manual_clocks.h"

namespace roomcal::drivers {
namespace {

struct CountedWake final : LibraryCamera::Wake {
  void wake() override { ++count; }
  int count = 0;
};

// Only ever passed on, never looked into.
libcamera::Request* request(std::uintptr_t number) { return reinterpret_cast<libcamera::Request*>(number); }

class CompletionsTest : public testing::Test {
 protected:
  CompletionsTest() { completions_.begin(wake_); }

  fakes::ManualClocks clock_;
  CountedWake wake_;
  Completions completions_{clock_};
};

TEST_F(CompletionsTest, Requests_ComeInOrderWithTheirArrival) {
  completions_.request_completed(request(1));
  clock_.advance(5);
  completions_.request_completed(request(2));
  EXPECT_EQ(wake_.count, 2);
  Completion first, second, none;
  ASSERT_TRUE(completions_.take(first));
  ASSERT_TRUE(completions_.take(second));
  EXPECT_FALSE(completions_.take(none));
  EXPECT_EQ(first.request, request(1));
  EXPECT_EQ(second.request, request(2));
  EXPECT_EQ(second.arrived_ns - first.arrived_ns, 5);
}

TEST_F(CompletionsTest, MoreThanThereAreRequests_AreDropped) {
  for (std::uintptr_t i = 1; i <= kMaxLibraryBuffers + 5; ++i) completions_.request_completed(request(i));
  int taken = 0;
  for (Completion completion; completions_.take(completion);) ++taken;
  EXPECT_EQ(taken, kMaxLibraryBuffers);
}

TEST_F(CompletionsTest, Disconnection_IsToldUntilTheNextBegin) {
  EXPECT_FALSE(completions_.disconnected());
  completions_.camera_disconnected();
  EXPECT_TRUE(completions_.disconnected());
  EXPECT_EQ(wake_.count, 1);
  completions_.begin(wake_);
  EXPECT_FALSE(completions_.disconnected());
}

TEST_F(CompletionsTest, AfterTheEnd_NobodyIsTold) {
  completions_.end();
  completions_.request_completed(request(1));
  Completion none;
  EXPECT_FALSE(completions_.take(none));
  EXPECT_EQ(wake_.count, 0);
}

}  // namespace
}  // namespace roomcal::drivers
