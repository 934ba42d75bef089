#include "drivers/os/linux_clocks.h"

#include <csignal>

#include <gtest/gtest.h>
#include <sys/time.h>

#include "drivers/os/time_ns.h"

namespace roomcal::drivers {
namespace {

constexpr int64_t kMillisecond = 1'000'000;

TEST(TimeNs, BothWays_KeepEveryNanosecond) {
  for (const int64_t ns :
       {int64_t{0}, int64_t{999'999'999}, int64_t{1'000'000'000}, int64_t{1'800'000'000'123'456'789}})
    EXPECT_EQ(to_ns(to_timespec(ns)), ns);
  EXPECT_EQ(to_ns(int64_t{1'800'000'000}, int64_t{7}), 1'800'000'000'000'000'007);
}

TEST(LinuxClocks, Monotonic_NeverStepsBack) {
  const LinuxClocks clocks;
  int64_t last_ns = clocks.now_ns();
  for (int i = 0; i < 1000; ++i) {
    const int64_t now_ns = clocks.read(ClockId::kMonotonic).ns;
    EXPECT_GE(now_ns, last_ns);
    last_ns = now_ns;
  }
}

TEST(LinuxClocks, EveryClock_CarriesItsName) {
  const LinuxClocks clocks;
  for (const ClockId id : {ClockId::kMonotonic, ClockId::kRealtime, ClockId::kBoottime, ClockId::kTai}) {
    EXPECT_EQ(clocks.read(id).clock, id);
    EXPECT_GT(clocks.read(id).ns, 0) << to_string(id);
  }
  EXPECT_GE(clocks.read(ClockId::kBoottime).ns, clocks.read(ClockId::kMonotonic).ns - kMillisecond);
  const int64_t ahead_ns = clocks.read(ClockId::kTai).ns - clocks.read(ClockId::kRealtime).ns;
  EXPECT_GE(ahead_ns, -kMillisecond);
  EXPECT_LT(ahead_ns, 60'000 * kMillisecond) << "37 s, or 0 where nobody told the kernel";
}

TEST(LinuxClocks, ClockThatTheHostHasNot_IsZero) {
  EXPECT_EQ(LinuxClocks().read(ClockId::kDevice), (Stamp{0, ClockId::kDevice}));
  EXPECT_EQ(LinuxClocks().read(ClockId::kUnknown).ns, 0);
}

TEST(LinuxClocks, SleepUntil_ReturnsNotBefore) {
  const LinuxClocks clocks;
  const int64_t deadline_ns = clocks.now_ns() + 5 * kMillisecond;
  clocks.sleep_until(deadline_ns);
  EXPECT_GE(clocks.now_ns(), deadline_ns);
}

TEST(LinuxClocks, PastDeadline_ReturnsAtOnce) {
  const LinuxClocks clocks;
  const int64_t before_ns = clocks.now_ns();
  clocks.sleep_until(before_ns - 1);
  clocks.sleep_until(0);
  clocks.sleep_until(-5);
  EXPECT_LT(clocks.now_ns() - before_ns, 1000 * kMillisecond);
}

TEST(LinuxClocks, SignalsWhileAsleep_DoNotShortenIt) {
  const auto before = std::signal(SIGALRM, [](int) {});
  const itimerval every_ms = {{0, 1000}, {0, 1000}};
  ASSERT_EQ(::setitimer(ITIMER_REAL, &every_ms, nullptr), 0);
  const LinuxClocks clocks;
  const int64_t deadline_ns = clocks.now_ns() + 20 * kMillisecond;
  clocks.sleep_until(deadline_ns);
  const int64_t woken_ns = clocks.now_ns();
  const itimerval never{};
  ASSERT_EQ(::setitimer(ITIMER_REAL, &never, nullptr), 0);
  std::signal(SIGALRM, before);
  EXPECT_GE(woken_ns, deadline_ns);
}

}  // namespace
}  // namespace roomcal::drivers
