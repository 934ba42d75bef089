// Recorded packets over loopback give the same sweeps as the file that they come from.

#include <cstring>

#include "drivers/lidar_udp/udp_packet_source.h"
#include "runtime/lidar/sweep_builder.h"
#include "tests/drivers/emulated.h"
#include "tests/drivers/lidar_udp/udp_sender.h"
#include "tests/tools/sweep/captures.h"
#include "tools/common/files.h"
#include "tools/sweep/load_sweeps.h"

namespace roomcal::drivers {
namespace {

namespace fs = std::filesystem;

// Builds sweeps of what comes out of the port, and compares each with the file's.
class Comparison final : public ports::PacketVisitor {
 public:
  explicit Comparison(const tools::Recording& expected)
      : expected_(expected),
        bytes_(lidar::SweepBuilder::arena_bytes(kOptions)),
        arena_(bytes_),
        builder_(lidar::SweepBuilder::create(expected.calibration, kOptions, arena_)) {
    EXPECT_TRUE(builder_.ok());
  }
  void take(const ports::Packet& packet) override {
    if (lidar::classify_packet(expected_.calibration.model, packet.payload) != lidar::PacketKind::kPoints) return;
    static_cast<void>(builder_.value().push(packet.payload).ok());
    compare();
  }
  void finish() {
    builder_.value().finish();
    compare();
    EXPECT_EQ(sweeps_, expected_.sweeps.size());
  }

 private:
  static constexpr lidar::SweepOptions kOptions = {.capacity = 1'000'000};

  void compare() {
    if (!builder_.value().ready()) return;
    ASSERT_LT(sweeps_, expected_.sweeps.size());
    const lidar::Sweep& sweep = builder_.value().sweep();
    const tools::LoadedSweep& expected = expected_.sweeps[sweeps_++];
    EXPECT_EQ(sweep.stamp, expected.facts.stamp);
    EXPECT_EQ(sweep.flags, expected.facts.flags);
    ASSERT_EQ(sweep.points.size(), expected.points.size());
    for (std::size_t i = 0; i < sweep.points.size(); ++i) {
      const lidar::SweepPoint &a = sweep.points[i], &b = expected.points[i];
      ASSERT_TRUE(a.x_m == b.x_m && a.y_m == b.y_m && a.z_m == b.z_m && a.offset_ns == b.offset_ns &&
                  a.beam == b.beam && a.reflectivity == b.reflectivity && a.return_index == b.return_index)
          << "point " << i;
    }
  }

  const tools::Recording& expected_;
  std::vector<std::byte> bytes_;
  Arena arena_;
  Result<lidar::SweepBuilder> builder_;
  std::size_t sweeps_ = 0;
};

void expect_same_sweeps(const fs::path& capture, const std::string& model, const fs::path& calibration = {}) {
  if (test::emulated()) GTEST_SKIP() << "the emulator does not count a socket's drops";
  tools::LoadRequest request;
  request.file = capture;
  request.model = model;
  request.calibration = calibration;
  const tools::Recording expected = tools::load_sweeps(request);
  UdpOptions options;
  options.port = test::free_port();
  options.max_payload = 24'832;
  options.packets_per_second = 640;
  options.stall_ms = 12;  // eight packets: so much every user gets
  std::vector<std::byte> memory(UdpPacketSource::memory_bytes(options));
  UdpPacketSource source(options, memory);
  const Status started = source.start();
  ASSERT_TRUE(started.ok()) << started.detail();
  Comparison comparison(expected);
  test::UdpSender lidar("127.0.0.1", "127.0.0.1", options.port);
  const tools::AlignedBytes bytes = tools::read_bytes(capture);
  tools::PcapReader reader(capture.string(), bytes.span());
  uint64_t sent = 0;
  for (tools::Datagram datagram; reader.next(datagram); ++sent) {
    ASSERT_TRUE(lidar.send(datagram.payload));
    if (sent % 8 == 7) source.drain(comparison);
  }
  source.drain(comparison);
  comparison.finish();
  EXPECT_EQ(source.counters().delivered, sent);
  EXPECT_EQ(source.counters().kernel_drops, 0U);
}

TEST(UdpCaptures, VelodyneCorridor_SameSweepsAsTheFile) {
  ROOMCAL_CAPTURE(capture, "lidar/velodyne/veloview_vlp-16-test-90deg-1-50-frames.pcap");
  expect_same_sweeps(capture, "vlp16");
}

TEST(UdpCaptures, VelodyneDualReturn_SameSweepsAsTheFile) {
  ROOMCAL_CAPTURE(capture, "lidar/velodyne/velodyne_vlp16.pcap");
  expect_same_sweeps(capture, "vlp16");
}

TEST(UdpCaptures, HesaiXt32_SameSweepsAsTheFile) {
  ROOMCAL_CAPTURE(capture, "lidar/hesai/hesai_xt32.pcap");
  expect_same_sweeps(capture, "xt32", capture.parent_path().parent_path() / "calibration/PandarXT32.csv");
}

TEST(UdpCaptures, HesaiQt64_SameSweepsAsTheFile) {
  ROOMCAL_CAPTURE(capture, "lidar/hesai/hesai_qt64.pcap");
  expect_same_sweeps(capture, "qt64", capture.parent_path().parent_path() / "calibration/PandarQT64.csv");
}

TEST(UdpCaptures, OusterWithLongPackets_SameSweepsAsTheFile) {
  for (const char* name : {"OS-0-128-U1_v2.3.0_1024x10", "OS-0-32-U1_v2.2.0_1024x10"}) {
    ROOMCAL_CAPTURE(capture, std::string("lidar/ouster/") + name + ".pcap");
    expect_same_sweeps(capture, "ouster", fs::path(capture).replace_extension(".json"));
  }
}

}  // namespace
}  // namespace roomcal::drivers
