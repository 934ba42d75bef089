// Two VLP-16 at ten times their rate over loopback: whatever was sent was delivered or counted.
// ROOMCAL_UDP_SECONDS: how long (3).

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "drivers/lidar_udp/udp_packet_source.h"
#include "drivers/os/linux_clocks.h"
#include "drivers/os/thread.h"
#include "drivers/os/time_ns.h"
#include "drivers/os/wait.h"
#include "tests/drivers/emulated.h"
#include "tests/drivers/lidar_udp/udp_sender.h"

namespace roomcal::drivers {
namespace {

constexpr uint32_t kVlp16Rate = 754, kSpeed = 10;
constexpr std::size_t kVlp16Payload = 1206;
constexpr int64_t kSecond_ns = 1'000'000'000, kMillisecond_ns = 1'000'000;

int64_t flood_seconds() {
  const char* text = std::getenv("ROOMCAL_UDP_SECONDS");
  return text == nullptr ? 3 : std::max(1, std::atoi(text));
}

uint64_t packets_to_send() { return static_cast<uint64_t>(flood_seconds()) * kVlp16Rate * kSpeed; }

// Sends numbered packets at its rate, in bursts of a millisecond; all of them, whatever else the machine does.
struct Lidar final : Thread::Body {
  Lidar(const char* from, uint16_t port) : socket(from, "127.0.0.1", port) {}
  void run() override {
    const LinuxClocks clocks;
    std::array<std::byte, kVlp16Payload> packet{};
    const int64_t start_ns = clocks.now_ns();
    while (sent < packets_to_send()) {
      const int64_t now_ns = clocks.now_ns();
      const auto due = static_cast<uint64_t>((now_ns - start_ns) * kVlp16Rate * kSpeed / kSecond_ns);
      for (; sent < std::min(due, packets_to_send()); ++sent) {
        std::memcpy(packet.data(), &sent, sizeof sent);
        if (!socket.send(packet)) break;
      }
      clocks.sleep_until(now_ns + kMillisecond_ns);
    }
  }
  test::UdpSender socket;
  uint64_t sent = 0;
};

// Reads one port until it is told to stop and nothing more comes; checks that numbers only rise.
struct Reader final : Thread::Body, ports::PacketVisitor {
  Reader(uint16_t port, const char* sender, uint32_t packets_per_second, uint32_t stall_ms, int64_t pause)
      : options(make(port, sender, packets_per_second, stall_ms)),
        memory(UdpPacketSource::memory_bytes(options)),
        source(options, memory),
        pause_ns(pause) {}

  static UdpOptions make(uint16_t port, const char* sender, uint32_t packets_per_second, uint32_t stall_ms) {
    UdpOptions result;
    result.name = "lidar";
    result.port = port;
    result.sender = sender;
    result.packets_per_second = packets_per_second;
    result.stall_ms = stall_ms;
    return result;
  }
  void take(const ports::Packet& packet) override {
    uint64_t number = 0;
    std::memcpy(&number, packet.payload.data(), sizeof number);
    in_order = in_order && (taken == 0 || number > last);
    gaps += taken == 0 ? number : number - last - 1;
    last = number;
    ++taken;
  }
  void run() override {
    const LinuxClocks clocks;
    while (true) {
      const bool last_look = stop;
      const uint32_t ready = wait_readable(std::array{source.fd()}, clocks.now_ns() + 50 * kMillisecond_ns);
      if (ready != 0) source.drain(*this);
      if (ready == 0 && last_look) break;
      if (pause_ns > 0) clocks.sleep_until(clocks.now_ns() + pause_ns);
    }
    source.drain(*this);
    rusage usage{};
    ::getrusage(RUSAGE_THREAD, &usage);
    cpu_ns = to_ns(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec, 0) +
             (int64_t{usage.ru_utime.tv_usec} + usage.ru_stime.tv_usec) * 1000;
  }

  const UdpOptions options;
  std::vector<std::byte> memory;
  UdpPacketSource source;
  const int64_t pause_ns;
  std::atomic<bool> stop = false;
  bool in_order = true;
  uint64_t taken = 0, last = 0, gaps = 0;
  int64_t cpu_ns = 0;
};

void check(const char* title, std::size_t i, const Lidar& lidar, const Reader& reader) {
  const ports::PacketCounters& counters = reader.source.counters();
  std::printf("%s, lidar%zu: sent %llu, delivered %llu, dropped by the kernel %llu; %.2f us a packet\n", title, i,
              static_cast<unsigned long long>(lidar.sent), static_cast<unsigned long long>(counters.delivered),
              static_cast<unsigned long long>(counters.kernel_drops),
              static_cast<double>(reader.cpu_ns) / 1000 / static_cast<double>(std::max<uint64_t>(reader.taken, 1)));
  EXPECT_EQ(lidar.sent, packets_to_send());
  EXPECT_EQ(lidar.sent, counters.delivered + counters.kernel_drops);
  EXPECT_EQ(counters.delivered, reader.taken);
  EXPECT_EQ(counters.foreign + counters.truncated + counters.errors, 0U);
  EXPECT_TRUE(reader.in_order);
  EXPECT_LE(reader.gaps, counters.kernel_drops) << "the rest was lost behind the last packet";
}

/// @return what the kernel dropped of both.
uint64_t flood(uint32_t packets_per_second, uint32_t stall_ms, int64_t pause_ns, const char* title) {
  constexpr std::array kSenders = {"127.0.0.2", "127.0.0.3"};
  const std::array ports = {test::free_port(), test::free_port()};
  std::array readers = {Reader(ports[0], kSenders[0], packets_per_second, stall_ms, pause_ns),
                        Reader(ports[1], kSenders[1], packets_per_second, stall_ms, pause_ns)};
  std::array lidars = {Lidar(kSenders[0], ports[0]), Lidar(kSenders[1], ports[1])};
  std::array<Thread, 2> reading, sending;
  for (std::size_t i = 0; i < 2; ++i) {
    const Status started = readers[i].source.start();
    EXPECT_TRUE(started.ok()) << started.detail();
    EXPECT_TRUE(reading[i].start({.name = "reader"}, readers[i]).ok());
  }
  for (std::size_t i = 0; i < 2; ++i) EXPECT_TRUE(sending[i].start({.name = "lidar"}, lidars[i]).ok());
  for (Thread& thread : sending) thread.join();
  for (Reader& reader : readers) reader.stop = true;
  for (Thread& thread : reading) thread.join();
  for (std::size_t i = 0; i < 2; ++i) check(title, i, lidars[i], readers[i]);
  return readers[0].source.counters().kernel_drops + readers[1].source.counters().kernel_drops;
}

class UdpFlood : public testing::Test {
 protected:
  void SetUp() override {
    if (test::emulated()) GTEST_SKIP() << "the emulator does not count a socket's drops";
  }
};

TEST_F(UdpFlood, TwoLidarsAtTenTimesTheirRate_SentIsDeliveredOrCounted) {
  constexpr uint32_t kRate = kVlp16Rate * kSpeed;
  Reader trial(test::free_port(), "", kRate, 100, 0);
  const uint32_t stall_ms = trial.source.start().ok() ? 100 : 20;  // so much every user gets
  trial.source.stop();
  flood(kRate, stall_ms, 0, stall_ms == 100 ? "buffer of 100 ms" : "buffer of 20 ms");
}

TEST_F(UdpFlood, TinyBufferAndALazyReader_SentIsDeliveredOrCounted) {
  EXPECT_GT(flood(10, 20, 2 * kMillisecond_ns, "tiny buffer"), 0U) << "nothing was lost: the case was none";
}

}  // namespace
}  // namespace roomcal::drivers
