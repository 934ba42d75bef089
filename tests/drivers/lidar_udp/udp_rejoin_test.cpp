// A LiDAR on a multicast group behind a network adapter that is missing at the start, or unplugged and plugged in
// again: a TAP device in a network of the test's own.

#include <array>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "drivers/lidar_udp/udp_packet_source.h"
#include "drivers/os/linux_clocks.h"
#include "tests/drivers/emulated.h"

namespace roomcal::drivers {
namespace {

constexpr const char* kName = "lidar-net";
constexpr const char* kGroup = "239.192.0.1";
constexpr uint16_t kPort = 2368;
constexpr std::size_t kPayload = 1206;

/// Plugged in while it lives.
class Adapter {
 public:
  Adapter() : fd_(::open("/dev/net/tun", O_RDWR | O_CLOEXEC)) {
    ifreq request = named();
    request.ifr_flags = IFF_TAP | IFF_NO_PI;
    plugged_ = fd_.valid() && ::ioctl(fd_.get(), TUNSETIFF, &request) == 0 && give_address() && bring(true);
  }
  bool plugged() const { return plugged_; }

  bool bring(bool up) const {
    const UniqueFd control(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    ifreq request = named();
    request.ifr_flags = up ? IFF_UP | IFF_RUNNING : 0;
    return ::ioctl(control.get(), SIOCSIFFLAGS, &request) == 0;
  }

  /// A packet of the sensor comes over the wire.
  bool arrives() const {
    std::vector<uint8_t> frame = {0x01, 0x00, 0x5e, 0x40, 0x00, 0x01, 2, 0, 0, 0, 0, 2, 0x08, 0x00};  // group's MAC
    std::array<uint8_t, 28> head = {0x45, 0, 0, 0, 0, 1, 0, 0, 1, 17, 0, 0, 10, 9, 9, 201};           // TTL 1, UDP
    const in_addr_t group = ::inet_addr(kGroup);
    std::memcpy(&head[16], &group, 4);
    put(head, 2, head.size() + kPayload);
    put(head, 10, sum_of(head));
    put(head, 20, kPort);
    put(head, 22, kPort);
    put(head, 24, 8 + kPayload);  // its sum stays 0: none
    frame.insert(frame.end(), head.begin(), head.end());
    frame.resize(frame.size() + kPayload, 0x5a);
    return ::write(fd_.get(), frame.data(), frame.size()) == static_cast<ssize_t>(frame.size());
  }

 private:
  static ifreq named() {
    ifreq request{};
    std::strncpy(request.ifr_name, kName, IFNAMSIZ - 1);
    return request;
  }
  static bool give_address() {
    const UniqueFd control(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    ifreq request = named();
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = ::inet_addr("10.9.9.1");
    std::memcpy(&request.ifr_addr, &address, sizeof address);
    if (::ioctl(control.get(), SIOCSIFADDR, &request) != 0) return false;
    address.sin_addr.s_addr = ::inet_addr("255.255.255.0");
    std::memcpy(&request.ifr_netmask, &address, sizeof address);
    return ::ioctl(control.get(), SIOCSIFNETMASK, &request) == 0;
  }
  static void put(std::array<uint8_t, 28>& head, std::size_t at, std::size_t value) {
    head[at] = static_cast<uint8_t>(value >> 8);
    head[at + 1] = static_cast<uint8_t>(value);
  }
  // RFC 1071, over the 20 bytes of the IP header.
  static std::size_t sum_of(const std::array<uint8_t, 28>& head) {
    uint32_t sum = 0;
    for (std::size_t i = 0; i < 20; i += 2) sum += static_cast<uint32_t>(head[i] << 8 | head[i + 1]);
    while (sum > 0xFFFF) sum = (sum & 0xFFFF) + (sum >> 16);
    return ~sum & 0xFFFF;
  }

  UniqueFd fd_;
  bool plugged_ = false;
};

struct Count final : ports::PacketVisitor {
  void take(const ports::Packet& packet) override { bytes += packet.payload.size(); }
  std::size_t bytes = 0;
};

class UdpRejoinTest : public testing::Test {
 protected:
  void SetUp() override {
    if (test::emulated()) GTEST_SKIP() << "the emulator does not count a socket's drops";
    if (::unshare(CLONE_NEWNET) != 0 && ::unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0)
      GTEST_SKIP() << "no network of its own for this user: run as root, or allow user namespaces";
    adapter_.emplace();
    if (!adapter_->plugged()) GTEST_SKIP() << "the kernel makes no TAP device: modprobe tun";
    UdpOptions options;
    options.name = "lidar0";
    options.port = kPort;
    options.group = kGroup;
    options.interface = kName;
    options.packets_per_second = 100;
    memory_.resize(UdpPacketSource::memory_bytes(options));
    source_.emplace(options, memory_);
    const Status started = source_->start();
    ASSERT_TRUE(started.ok()) << started.detail();
  }

  /// As at the start of a device whose adapter is not there.
  void start_without_adapter() {
    adapter_.reset();
    const Status started = source_->start();
    EXPECT_EQ(started.code(), StatusCode::kNotFound) << started.detail();
    EXPECT_EQ(source_->fd(), -1);
  }

  /// The sensor sends a hundred times a second. @return seconds until something of it came; 0: not within five.
  double until_packets_come() {
    const int64_t begin_ns = clocks_.now_ns();
    Count count;
    while (clocks_.now_ns() - begin_ns < 5'000'000'000) {
      EXPECT_TRUE(adapter_->arrives());
      clocks_.sleep_until(clocks_.now_ns() + 10'000'000);
      if (source_->drain(count) > 0) return static_cast<double>(clocks_.now_ns() - begin_ns) * 1e-9;
    }
    return 0;
  }

  LinuxClocks clocks_;
  std::optional<Adapter> adapter_;
  std::vector<std::byte> memory_;
  std::optional<UdpPacketSource> source_;
};

TEST_F(UdpRejoinTest, AdapterUnpluggedAndBack_PacketsComeAgainSoon) {
  ASSERT_GT(until_packets_come(), 0);
  for (int i = 0; i < 3; ++i) {
    const unsigned before = ::if_nametoindex(kName);
    adapter_.reset();
    Count none;
    EXPECT_EQ(source_->drain(none), 0U);
    adapter_.emplace();
    ASSERT_TRUE(adapter_->plugged());
    ASSERT_NE(::if_nametoindex(kName), before) << "the kernel gives a new adapter a new number";
    const double seconds = until_packets_come();
    EXPECT_GT(seconds, 0) << "never";
    EXPECT_LT(seconds, 2);
  }
  EXPECT_EQ(source_->counters().errors, 0U);
}

TEST_F(UdpRejoinTest, AdapterMissingAtTheStart_PacketsComeOnceItIsThere) {
  start_without_adapter();
  Count none;
  EXPECT_EQ(source_->drain(none), 0U);
  adapter_.emplace();
  ASSERT_TRUE(adapter_->plugged());
  const double seconds = until_packets_come();
  EXPECT_GT(seconds, 0) << "never";
  EXPECT_LT(seconds, 2);
  EXPECT_EQ(source_->counters().errors, 0U);
}

TEST_F(UdpRejoinTest, StoppedWhileItsAdapterIsMissing_StaysClosed) {
  start_without_adapter();
  source_->stop();
  adapter_.emplace();
  clocks_.sleep_until(clocks_.now_ns() + 600'000'000);
  Count none;
  EXPECT_EQ(source_->drain(none), 0U);
  EXPECT_EQ(source_->fd(), -1);
}

TEST_F(UdpRejoinTest, AdapterDownAndUp_PacketsComeAgain) {
  ASSERT_GT(until_packets_come(), 0);
  ASSERT_TRUE(adapter_->bring(false));
  ASSERT_TRUE(adapter_->bring(true));
  EXPECT_GT(until_packets_come(), 0);
}

}  // namespace
}  // namespace roomcal::drivers
