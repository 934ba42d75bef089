#include "drivers/os/thread.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mman.h>

#include "drivers/os/page_faults.h"
#include "tests/drivers/as_nobody.h"
#include "tests/drivers/emulated.h"

namespace roomcal::drivers {
namespace {

template <typename Work>
class Does final : public Thread::Body {
 public:
  explicit Does(Work work) : work_(std::move(work)) {}
  void run() override { work_(); }

 private:
  Work work_;
};

// Uses some more than `bytes` of stack, and touches it.
__attribute__((noinline, noclone)) int go_deep(int bytes) {
  volatile char here[1024];
  for (std::size_t i = 0; i < sizeof here; i += 64) here[i] = static_cast<char>(bytes);
  return bytes <= 0 ? here[0] : go_deep(bytes - 1024) + here[64];
}

// A sanitizer's frames are several times as large.
#if defined(__SANITIZE_ADDRESS__)
constexpr int kFrameFactor = 4;
#else
constexpr int kFrameFactor = 1;
#endif

TEST(Thread, Started_RunsUnderItsNameOnItsStack) {
  std::array<char, 16> name{};
  const std::byte* local = nullptr;
  Does body([&] {
    std::byte here{};
    local = &here;
    ::pthread_getname_np(::pthread_self(), name.data(), name.size());
  });
  LockedMemory memory;
  ASSERT_TRUE(memory.reserve(256 * 1024).ok());
  Thread thread;
  ASSERT_TRUE(thread.start({.name = "lidar0"}, body, memory.bytes()).ok());
  thread.join();
  EXPECT_STREQ(name.data(), "lidar0");
  EXPECT_GE(local, memory.bytes().data());
  EXPECT_LT(local, memory.bytes().data() + memory.bytes().size());
  EXPECT_EQ(thread.stack_bytes(), 256 * 1024 - 4096U);
}

TEST(Thread, StackPeak_IsHowDeepItWent) {
  std::array<std::size_t, 2> peak{};
  for (std::size_t i = 0; i < peak.size(); ++i) {
    Does body([i] { go_deep(static_cast<int>(i) * 64 * 1024); });
    Thread thread;
    ASSERT_TRUE(thread.start({.stack_bytes = 1024 * 1024}, body).ok());
    thread.join();
    peak[i] = thread.stack_peak();
  }
  EXPECT_LT(peak[0], 32U * 1024 * kFrameFactor);
  EXPECT_GT(peak[1], peak[0] + 64 * 1024);
  EXPECT_LT(peak[1], peak[0] + 96 * 1024 * kFrameFactor);
}

TEST(Thread, WholeStack_IsThereBeforeItRuns) {
  if (test::emulated()) GTEST_SKIP() << "an emulator's own page faults are counted with ours";
  PageFaults faults;
  Does body([&] {
    go_deep(1024);  // the code itself
    const PageFaultMark mark;
    go_deep(150 * 1024 / kFrameFactor);
    faults = mark.since();
  });
  Thread thread;
  ASSERT_TRUE(thread.start({.stack_bytes = 256 * 1024}, body).ok());
  thread.join();
#if !defined(__SANITIZE_ADDRESS__)  // its shadow memory comes page by page
  EXPECT_EQ(faults.minor + faults.major, 0U);
#endif
}

TEST(ThreadDeathTest, Overflow_EndsAtTheGuardPage) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_DEATH(
      {
        Does body([] { go_deep(1024 * 1024); });
        Thread thread;
        static_cast<void>(thread.start({.stack_bytes = 256 * 1024}, body));
        thread.join();
      },
      "");
}

TEST(Thread, StackGivenBack_IsOrdinaryMemoryAgain) {
  LockedMemory memory;
  ASSERT_TRUE(memory.reserve(128 * 1024).ok());
  Does body([] {});
  for (int i = 0; i < 3; ++i) {
    Thread thread;
    ASSERT_TRUE(thread.start({}, body, memory.bytes()).ok());
    thread.join();
    memory.bytes()[0] = std::byte{1};  // the guard page
  }
}

TEST(Thread, RealTimePriority_IsHadOrMissed) {
  int policy = -1;
  std::atomic<bool> go = false;
  Does body([&] {
    while (!go) ::sched_yield();
    policy = ::sched_getscheduler(0);
  });
  Thread thread;
  ASSERT_TRUE(thread.start({.fifo_priority = 10}, body).ok());
  go = true;
  thread.join();
  EXPECT_EQ(policy == SCHED_FIFO, thread.priority_status().ok());
}

TEST(Thread, NoRightToPriority_RunsAndSaysSo) {
  const test::AsNobody nobody;
  bool ran = false;
  Does body([&] { ran = true; });
  Thread thread;
  ASSERT_TRUE(thread.start({.fifo_priority = 10}, body).ok());
  thread.join();
  EXPECT_TRUE(ran);
  EXPECT_EQ(thread.priority_status().code(), StatusCode::kUnavailable);
  EXPECT_NE(std::string(thread.priority_status().detail()).find("LimitRTPRIO"), std::string::npos);
}

TEST(Thread, UnfitStack_IsRefused) {
  LockedMemory memory;
  ASSERT_TRUE(memory.reserve(256 * 1024).ok());
  Does body([] {});
  Thread thread;
  EXPECT_EQ(thread.start({}, body, memory.bytes().subspan(64)).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(thread.start({}, body, memory.bytes().first(100 * 1000)).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(thread.start({}, body, memory.bytes().first(8192)).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(thread.start({.stack_bytes = 0}, body).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(thread.start({.stack_bytes = SIZE_MAX - 65'536}, body).code(), StatusCode::kOutOfMemory);
  EXPECT_FALSE(thread.joinable());
}

TEST(Thread, RunningAlready_IsRefused) {
  std::atomic<bool> go = false;
  Does body([&] {
    while (!go) ::sched_yield();
  });
  Thread thread;
  ASSERT_TRUE(thread.start({}, body).ok());
  EXPECT_EQ(thread.start({}, body).code(), StatusCode::kUnavailable);
  go = true;
}

}  // namespace
}  // namespace roomcal::drivers
