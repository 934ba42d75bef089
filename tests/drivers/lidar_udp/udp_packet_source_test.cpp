#include "drivers/lidar_udp/udp_packet_source.h"

#include <array>
#include <cerrno>
#include <optional>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>

#include "drivers/os/linux_clocks.h"
#include "drivers/os/wait.h"
#include "tests/drivers/as_nobody.h"
#include "tests/drivers/emulated.h"
#include "tests/drivers/lidar_udp/udp_sender.h"

namespace roomcal::drivers {
namespace {

using test::free_port;
using test::UdpSender;

struct Seen final : ports::PacketVisitor {
  void take(const ports::Packet& packet) override {
    payloads.emplace_back(packet.payload.begin(), packet.payload.end());
    arrived.push_back(packet.arrived);
  }
  std::vector<std::vector<std::byte>> payloads;
  std::vector<Stamp> arrived;
};

std::vector<std::byte> payload(std::size_t size, int value) { return std::vector(size, static_cast<std::byte>(value)); }

class UdpPacketSourceTest : public testing::Test {
 protected:
  void SetUp() override {
    if (test::emulated()) GTEST_SKIP() << "the emulator does not count a socket's drops";
  }
  UdpOptions options(uint32_t packets_per_second = 1000) const {
    UdpOptions result;
    result.name = "lidar0";
    result.port = port_;
    result.packets_per_second = packets_per_second;
    return result;
  }
  void start(const UdpOptions& with) {
    memory_.resize(UdpPacketSource::memory_bytes(with));
    source_.emplace(with, memory_);
    const Status started = source_->start();
    ASSERT_TRUE(started.ok()) << started.detail();
  }
  // Ordinary users get no more than net.core.rmem_max.
  bool system_grants(const UdpOptions& with) {
    memory_.resize(UdpPacketSource::memory_bytes(with));
    return UdpPacketSource(with, memory_).start().ok();
  }
  std::size_t drain() { return source_->drain(seen_); }
  static std::string refusal(const UdpOptions& with, StatusCode code) {
    std::vector<std::byte> memory(UdpPacketSource::memory_bytes(with));
    UdpPacketSource source(with, memory);
    const Status started = source.start();
    EXPECT_EQ(started.code(), code) << started.detail();
    EXPECT_EQ(source.fd(), -1);
    return started.detail();
  }

  const uint16_t port_ = free_port();
  std::vector<std::byte> memory_;
  std::optional<UdpPacketSource> source_;
  Seen seen_;
};

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST_F(UdpPacketSourceTest, Packets_ComeInOrderWithTheirStamps) {
  start(options());
  UdpSender lidar("127.0.0.1", "127.0.0.1", port_);
  const int64_t before_ns = LinuxClocks().read(ClockId::kRealtime).ns;
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(lidar.send(payload(1206, i)));
  EXPECT_EQ(wait_readable(std::array{source_->fd()}, LinuxClocks().now_ns() + 1'000'000'000), 1U);
  EXPECT_EQ(drain(), 100U);
  EXPECT_EQ(drain(), 0U);
  const int64_t after_ns = LinuxClocks().read(ClockId::kRealtime).ns;
  ASSERT_EQ(seen_.payloads.size(), 100U);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(seen_.payloads[i], payload(1206, static_cast<int>(i)));
    EXPECT_EQ(seen_.arrived[i].clock, ClockId::kRealtime);
    EXPECT_GE(seen_.arrived[i].ns, i == 0 ? before_ns : seen_.arrived[i - 1].ns);
    EXPECT_LE(seen_.arrived[i].ns, after_ns);
  }
  EXPECT_EQ(source_->counters().delivered, 100U);
}

TEST_F(UdpPacketSourceTest, OtherSenders_AreCountedAndLeftOut) {
  UdpOptions with = options();
  UdpSender lidar("127.0.0.2", "127.0.0.1", port_), port_twin("127.0.0.2", "127.0.0.1", port_),
      stranger("127.0.0.3", "127.0.0.1", port_);
  with.sender = "127.0.0.2";
  with.sender_port = lidar.port();
  start(with);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(stranger.send(payload(1206, 1)));
  ASSERT_TRUE(lidar.send(payload(1206, 2)));
  ASSERT_TRUE(port_twin.send(payload(1206, 3)));
  EXPECT_EQ(drain(), 1U);
  EXPECT_EQ(source_->counters().foreign, 4U);
  ASSERT_EQ(seen_.payloads.size(), 1U);
  EXPECT_EQ(seen_.payloads[0], payload(1206, 2));
}

TEST_F(UdpPacketSourceTest, TooLongPacket_IsCountedAndLeftOut) {
  start(options());
  UdpSender lidar("127.0.0.1", "127.0.0.1", port_);
  for (const std::size_t size :
       {std::size_t{1472}, std::size_t{1473}, std::size_t{9000}, std::size_t{0}, std::size_t{1}})
    ASSERT_TRUE(lidar.send(payload(size, 7)));
  EXPECT_EQ(drain(), 3U);
  EXPECT_EQ(source_->counters().truncated, 2U);
  ASSERT_EQ(seen_.payloads.size(), 3U);
  EXPECT_EQ(seen_.payloads[0].size(), 1472U);
  EXPECT_EQ(seen_.payloads[1].size(), 0U);
  EXPECT_EQ(seen_.payloads[2].size(), 1U);
}

TEST_F(UdpPacketSourceTest, LongestPacketOfAnOuster_Passes) {
  UdpOptions with = options(640);
  with.max_payload = 24'832;
  if (!system_grants(with)) GTEST_SKIP() << "this user gets too small a receive buffer; raise net.core.rmem_max";
  start(with);
  UdpSender lidar("127.0.0.1", "127.0.0.1", port_);
  for (int i = 0; i < 64; ++i) ASSERT_TRUE(lidar.send(payload(24'832, i)));  // a stall of 100 ms
  EXPECT_EQ(drain(), 64U);
  EXPECT_EQ(source_->counters().kernel_drops, 0U);
}

// Nothing comes behind the loss, and it is known all the same.
TEST_F(UdpPacketSourceTest, BufferFull_EveryLossIsCountedThoughTheStreamEnds) {
  start(options(1));
  UdpSender lidar("127.0.0.1", "127.0.0.1", port_);
  constexpr uint64_t kSent = 1000;
  for (uint64_t i = 0; i < kSent; ++i) ASSERT_TRUE(lidar.send(payload(1206, 0)));
  drain();
  EXPECT_GT(source_->counters().kernel_drops, 900U);
  EXPECT_EQ(source_->counters().delivered + source_->counters().kernel_drops, kSent);
}

// Where in the stream it was lost: the packet behind the loss tells.
TEST_F(UdpPacketSourceTest, BufferFullAmidst_TheCountRisesBeforeTheNextPacket) {
  start(options(1));
  struct Watch final : ports::PacketVisitor {
    void take(const ports::Packet& packet) override {
      drops.push_back(source->counters().kernel_drops);
      last = packet.payload[0];
    }
    const UdpPacketSource* source = nullptr;
    std::vector<uint64_t> drops;
    std::byte last{};
  } watch;
  watch.source = &*source_;
  UdpSender lidar("127.0.0.1", "127.0.0.1", port_);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(lidar.send(payload(1206, 1)));
  source_->drain(watch);
  const uint64_t lost = source_->counters().kernel_drops;
  EXPECT_GT(lost, 0U);
  EXPECT_EQ(watch.drops.front(), 0U);
  ASSERT_TRUE(lidar.send(payload(1206, 2)));
  source_->drain(watch);
  EXPECT_EQ(watch.last, std::byte{2});
  EXPECT_EQ(watch.drops.back(), lost);
}

TEST_F(UdpPacketSourceTest, OneDrain_HasABound) {
  if (!system_grants(options(50'000)))
    GTEST_SKIP() << "this user gets too small a receive buffer; raise net.core.rmem_max";
  start(options(50'000));
  UdpSender lidar("127.0.0.1", "127.0.0.1", port_);
  constexpr std::size_t kSent = UdpPacketSource::kMaxDrain + 10;
  for (std::size_t i = 0; i < kSent; ++i) ASSERT_TRUE(lidar.send(payload(100, 0)));
  EXPECT_EQ(drain(), UdpPacketSource::kMaxDrain);
  EXPECT_EQ(drain(), 10U);
}

TEST_F(UdpPacketSourceTest, Multicast_OnlyItsOwnGroupComes) {
  UdpOptions with = options();
  with.group = "239.192.0.1";
  with.interface = "lo";
  start(with);
  // Somebody else on this host listens to another group on the same port.
  UdpOptions other = with;
  other.group = "239.192.0.2";
  std::vector<std::byte> other_memory(UdpPacketSource::memory_bytes(other));
  UdpPacketSource neighbour(other, other_memory);
  ASSERT_TRUE(neighbour.start().ok());
  UdpSender ours("127.0.0.1", "239.192.0.1", port_), theirs("127.0.0.1", "239.192.0.2", port_),
      direct("127.0.0.1", "127.0.0.1", port_);
  ASSERT_TRUE(theirs.send(payload(1206, 2)));
  ASSERT_TRUE(direct.send(payload(1206, 3)));
  ASSERT_TRUE(ours.send(payload(1206, 1)));
  EXPECT_EQ(drain(), 1U);
  EXPECT_EQ(seen_.payloads[0], payload(1206, 1));
  EXPECT_EQ(source_->counters().foreign, 0U);
  Seen of_neighbour;
  EXPECT_EQ(neighbour.drain(of_neighbour), 1U);
}

TEST_F(UdpPacketSourceTest, MulticastWithASecondListener_BothGetAll) {
  UdpOptions with = options();
  with.group = "239.192.0.1";
  with.interface = "lo";
  start(with);
  std::vector<std::byte> second_memory(UdpPacketSource::memory_bytes(with));
  UdpPacketSource second(with, second_memory);
  ASSERT_TRUE(second.start().ok());
  UdpSender lidar("127.0.0.1", "239.192.0.1", port_);
  ASSERT_TRUE(lidar.send(payload(1206, 1)));
  Seen of_second;
  EXPECT_EQ(drain(), 1U);
  EXPECT_EQ(second.drain(of_second), 1U);
}

TEST_F(UdpPacketSourceTest, StoppedAndStarted_CountsAnew) {
  start(options());
  UdpSender lidar("127.0.0.1", "127.0.0.1", port_);
  ASSERT_TRUE(lidar.send(payload(1206, 1)));
  EXPECT_EQ(drain(), 1U);
  source_->stop();
  EXPECT_EQ(source_->fd(), -1);
  EXPECT_EQ(drain(), 0U);
  EXPECT_EQ(source_->counters().delivered, 1U);
  ASSERT_TRUE(source_->start().ok());
  EXPECT_EQ(source_->counters().delivered, 0U);
  ASSERT_TRUE(lidar.send(payload(1206, 1)));
  EXPECT_EQ(drain(), 1U);
}

TEST_F(UdpPacketSourceTest, ReceiveThatFails_IsCountedWithItsReason) {
  start(options());
  const UniqueFd file(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  ASSERT_EQ(::dup2(file.get(), source_->fd()), source_->fd());  // what is received from is no socket any more
  EXPECT_EQ(drain(), 0U);
  EXPECT_EQ(drain(), 0U);
  EXPECT_EQ(source_->counters().errors, 2U);
  EXPECT_EQ(source_->counters().error_number, ENOTSOCK);
  ASSERT_TRUE(source_->start().ok()) << "started anew, it works again";
  UdpSender lidar("127.0.0.1", "127.0.0.1", port_);
  ASSERT_TRUE(lidar.send(payload(1206, 1)));
  EXPECT_EQ(drain(), 1U);
}

TEST_F(UdpPacketSourceTest, PortTaken_IsNamed) {
  start(options());
  EXPECT_TRUE(contains(refusal(options(), StatusCode::kUnavailable), "taken"));
}

TEST_F(UdpPacketSourceTest, ImpossibleOptions_AreRefusedByName) {
  const auto with = [&](auto change) {
    UdpOptions result = options();
    change(result);
    return result;
  };
  constexpr auto kInvalid = StatusCode::kInvalidArgument;
  EXPECT_TRUE(contains(refusal(with([](UdpOptions& o) { o.port = 0; }), kInvalid), "port is 0"));
  EXPECT_TRUE(contains(refusal(with([](UdpOptions& o) { o.max_payload = 0; }), kInvalid), "65507"));
  EXPECT_TRUE(contains(refusal(with([](UdpOptions& o) { o.max_payload = 100'000; }), kInvalid), "65507"));
  EXPECT_TRUE(contains(refusal(with([](UdpOptions& o) { o.sender = "lidar.local"; }), kInvalid), "no IPv4"));
  EXPECT_TRUE(contains(refusal(with([](UdpOptions& o) { o.local = "1.2.3"; }), kInvalid), "no IPv4"));
  EXPECT_TRUE(contains(refusal(with([](UdpOptions& o) { o.group = "192.168.1.1"; }), kInvalid), "multicast"));
  EXPECT_TRUE(contains(refusal(with([](UdpOptions& o) { o.group = "239.1.1.1"; }), kInvalid), "interface"));
  const auto no_interface = with([](UdpOptions& o) {
    o.group = "239.1.1.1";
    o.interface = "nothere0";
  });
  EXPECT_TRUE(contains(refusal(no_interface, StatusCode::kNotFound), "ip link"));
  const auto no_address = with([](UdpOptions& o) { o.local = "192.0.2.1"; });  // kept for documents, RFC 5737
  EXPECT_TRUE(contains(refusal(no_address, StatusCode::kNotFound), "no interface has the address"));
}

TEST_F(UdpPacketSourceTest, TooLittleMemory_IsRefused) {
  std::vector<std::byte> memory(UdpPacketSource::memory_bytes(options()) / 2);
  UdpPacketSource source(options(), memory);
  EXPECT_EQ(source.start().code(), StatusCode::kOutOfMemory);
  EXPECT_EQ(source.fd(), -1);
}

TEST_F(UdpPacketSourceTest, KernelGrantsTooLittle_TheSysctlIsNamed) {
  const test::AsNobody nobody;
  UdpOptions with = options(2'000'000);
  with.stall_ms = 200;
  const std::string text = refusal(with, StatusCode::kUnavailable);
  EXPECT_TRUE(contains(text, "net.core.rmem_max=460801153")) << text;
}

TEST_F(UdpPacketSourceTest, ReceiveBuffer_HoldsTheStallThatItPromises) {
  UdpOptions with = options(754);
  with.stall_ms = 500;
  for (const uint32_t size : {200U, 1206U, 1472U, 3000U, 6464U, 8448U, 12'608U, 16'640U, 24'832U}) {
    with.max_payload = size;
    if (!system_grants(with)) GTEST_SKIP() << size << ": too small a receive buffer; raise net.core.rmem_max";
    start(with);
    UdpSender lidar("127.0.0.1", "127.0.0.1", port_);
    const std::size_t stall = 754 / 2;
    for (std::size_t i = 0; i < stall; ++i) ASSERT_TRUE(lidar.send(payload(size, 0)));
    EXPECT_EQ(drain(), stall) << size;
    EXPECT_EQ(source_->counters().kernel_drops, 0U) << size;
    source_->stop();
  }
}

}  // namespace
}  // namespace roomcal::drivers
