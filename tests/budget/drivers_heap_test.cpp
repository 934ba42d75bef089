// What runs on the device's threads after arming makes no heap call: the system's side of it.

#include <array>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "drivers/lidar_udp/udp_packet_source.h"
#include "drivers/os/linux_clocks.h"
#include "drivers/os/page_faults.h"
#include "drivers/os/thread.h"
#include "drivers/os/wait.h"
#include "tests/budget/heap_guard.h"
#include "tests/drivers/emulated.h"
#include "tests/drivers/lidar_udp/udp_sender.h"

namespace roomcal::drivers {
namespace {

class DriversHeap : public testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__)
    GTEST_SKIP() << "the sanitizer brings its own allocator";
#endif
  }
};

// One turn of a device's thread: waits, reads, looks at its clocks.
struct Loop final : Thread::Body {
  void run() override {
    const budget::HeapGuard guard;
    const PageFaultMark mark;
    const LinuxClocks clocks;
    for (int i = 0; i < 100; ++i) {
      std::array<char, 16> bytes{};
      if (wait_readable(std::array{fd}, clocks.now_ns() + 1'000'000) != 0) read_bytes += ::read(fd, bytes.data(), 1);
      clocks.sleep_until(clocks.read(ClockId::kMonotonic).ns + 1000);
    }
    faults = mark.since();
    calls = guard.calls();
  }
  int fd = -1;
  ssize_t read_bytes = 0;
  PageFaults faults;
  std::size_t calls = SIZE_MAX;
};

TEST_F(DriversHeap, ThreadAfterItsStart_NoCallNoPageFromDisk) {
  int ends[2] = {-1, -1};
  ASSERT_EQ(::pipe(ends), 0);
  ASSERT_EQ(::write(ends[1], "12345", 5), 5);
  Loop loop;
  loop.fd = ends[0];
  Thread thread;
  ASSERT_TRUE(thread.start({.name = "loop"}, loop).ok());
  thread.join();
  EXPECT_EQ(loop.read_bytes, 5);
  EXPECT_EQ(loop.calls, 0U);
  EXPECT_EQ(loop.faults.major, 0U);
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST_F(DriversHeap, UdpPacketsThroughLossAndRestart_NoCall) {
  if (test::emulated()) GTEST_SKIP() << "the emulator does not count a socket's drops";
  struct Count final : ports::PacketVisitor {
    void take(const ports::Packet& packet) override { bytes += packet.payload.size(); }
    std::size_t bytes = 0;
  } count;
  UdpOptions options;
  options.port = test::free_port();
  std::vector<std::byte> memory(UdpPacketSource::memory_bytes(options));
  UdpPacketSource source(options, memory);
  test::UdpSender lidar("127.0.0.1", "127.0.0.1", options.port);
  const std::vector<std::byte> packet(1206);
  uint64_t drops = 0;
  std::size_t calls = 0;
  bool ok = true;
  {
    const budget::HeapGuard guard;
    for (int i = 0; i < 3; ++i) {
      ok = ok && source.start().ok();
      for (int k = 0; k < 20; ++k) ok = ok && lidar.send(packet);
      source.drain(count);
      drops += source.counters().kernel_drops;
      source.stop();
    }
    calls = guard.calls();
  }
  EXPECT_TRUE(ok);
  EXPECT_GT(drops, 0U);
  EXPECT_EQ(count.bytes, 1206 * (60 - drops));
  EXPECT_EQ(calls, 0U);
}

}  // namespace
}  // namespace roomcal::drivers
