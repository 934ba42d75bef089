#include "drivers/os/wait.h"

#include <array>
#include <csignal>

#include <gtest/gtest.h>
#include <sys/time.h>
#include <unistd.h>

#include "drivers/os/linux_clocks.h"
#include "drivers/os/unique_fd.h"

namespace roomcal::drivers {
namespace {

struct Pipe {
  Pipe() {
    int ends[2] = {-1, -1};
    EXPECT_EQ(::pipe(ends), 0);
    out = UniqueFd(ends[0]);
    in = UniqueFd(ends[1]);
  }
  UniqueFd out, in;
};

int64_t now_ns() { return LinuxClocks().now_ns(); }

TEST(WaitReadable, BytesWaiting_SaysWhere) {
  const Pipe a, b, c;
  ASSERT_EQ(::write(b.in.get(), "x", 1), 1);
  EXPECT_EQ(wait_readable(std::array{a.out.get(), b.out.get(), c.out.get()}, now_ns() + 10'000'000'000), 0b010U);
  ASSERT_EQ(::write(c.in.get(), "x", 1), 1);
  EXPECT_EQ(wait_readable(std::array{a.out.get(), b.out.get(), c.out.get()}, 0), 0b110U);
}

TEST(WaitReadable, Nothing_ReturnsAtTheDeadline) {
  const Pipe a;
  const int64_t deadline_ns = now_ns() + 5'000'000;
  EXPECT_EQ(wait_readable(std::array{a.out.get()}, deadline_ns), 0U);
  EXPECT_GE(now_ns(), deadline_ns);
  EXPECT_EQ(wait_readable({}, now_ns() + 1'000'000), 0U);
}

TEST(WaitReadable, ClosedOnes_ArePassedOver) {
  const Pipe a;
  ASSERT_EQ(::write(a.in.get(), "x", 1), 1);
  EXPECT_EQ(wait_readable(std::array{-1, a.out.get(), -1}, now_ns() + 10'000'000'000), 0b010U);
}

TEST(WaitReadable, WriterHungUp_CountsAsReadable) {
  Pipe a;
  a.in.reset();
  EXPECT_EQ(wait_readable(std::array{a.out.get()}, now_ns() + 10'000'000'000), 0b001U);
}

TEST(WaitReadable, Signal_EndsTheWait) {
  const auto before = std::signal(SIGALRM, [](int) {});
  const itimerval soon = {{0, 0}, {0, 5000}};
  const Pipe a;
  ASSERT_EQ(::setitimer(ITIMER_REAL, &soon, nullptr), 0);
  const int64_t deadline_ns = now_ns() + 60'000'000'000;
  EXPECT_EQ(wait_readable(std::array{a.out.get()}, deadline_ns), 0U);
  EXPECT_LT(now_ns(), deadline_ns);
  std::signal(SIGALRM, before);
}

}  // namespace
}  // namespace roomcal::drivers
