// Recordings that are not as they should be: every fault is an error that names it, or a flag and a count.
#include "tools/sweep/load_sweeps.h"

#include <algorithm>
#include <array>

#include <gtest/gtest.h>

#include "tests/tools/refusal.h"
#include "tests/truth/lidar_box.h"
#include "tests/truth/random.h"
#include "tools/simulate/pcap_writer.h"

namespace roomcal::tools {
namespace {

using test::contains;
using test::refusal;

std::vector<Vlp16Packet> packets(std::size_t count) {
  Vlp16Stream stream;
  stream.first_ns = 1'000'000'000;
  const auto returns = truth::box_returns(stream, count * kVlp16FiringsPerPacket, {-1, -2, -1}, {2, 2, 1});
  std::vector<Vlp16Packet> result;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t first = i * kVlp16FiringsPerPacket;
    result.push_back(make_vlp16_packet(stream, first, std::span(returns).subspan(first * kVlp16Lasers)));
  }
  return result;
}

template <typename Payloads>
std::vector<std::byte> pcap(const Payloads& payloads) {
  PcapWriter writer;
  int64_t arrival_ns = 0;
  for (const auto& payload : payloads) writer.add(payload, arrival_ns += 1'000'000, 2368);
  return writer.bytes();
}

Recording load(const std::vector<std::byte>& bytes, const std::string& model = "vlp16") {
  LoadRequest request;
  request.model = model;
  return load_sweeps("a.pcap", bytes, request);
}

uint32_t all_flags(const Recording& recording) {
  uint32_t flags = 0;
  for (const LoadedSweep& sweep : recording.sweeps) flags |= sweep.facts.flags;
  return flags;
}

TEST(LoadSweeps, LostPackets_AreCountedWhereTheyAreMissing) {
  auto sent = packets(200);
  sent.erase(sent.begin() + 30, sent.begin() + 35);
  const Recording recording = load(pcap(sent));
  EXPECT_EQ(recording.report.counters.lost, 5U);
  EXPECT_EQ(recording.sweeps[0].facts.lost_packets, 5U);
  EXPECT_NE(recording.sweeps[0].facts.flags & lidar::kSweepLostPackets, 0U);
  EXPECT_EQ(recording.sweeps[1].facts.flags & lidar::kSweepLostPackets, 0U);
}

TEST(LoadSweeps, DuplicatesAndLatePackets_LoseNoPointAndAddNone) {
  const auto sent = packets(160);
  std::size_t points = 0;
  for (const LoadedSweep& sweep : load(pcap(sent)).sweeps) points += sweep.points.size();
  auto shuffled = sent;
  std::swap(shuffled[20], shuffled[21]);
  std::swap(shuffled[40], shuffled[43]);
  shuffled.insert(shuffled.begin() + 50, sent[49]);
  shuffled.insert(shuffled.begin() + 60, sent[45]);
  const Recording recording = load(pcap(shuffled));
  EXPECT_EQ(recording.report.counters.duplicates, 2U);
  EXPECT_EQ(recording.report.counters.late_used, 4U);
  EXPECT_EQ(recording.report.counters.late_dropped, 0U);
  EXPECT_EQ(recording.report.counters.lost, 0U);
  EXPECT_EQ(recording.sweeps[0].facts.flags, lidar::kSweepDuplicates | lidar::kSweepOutOfOrder);
  std::size_t again = 0;
  for (const LoadedSweep& sweep : recording.sweeps) again += sweep.points.size();
  EXPECT_EQ(again, points);
}

TEST(LoadSweeps, HalfATurn_IsPartial) {
  const Recording recording = load(pcap(packets(35)));
  ASSERT_EQ(recording.sweeps.size(), 1U);
  EXPECT_EQ(recording.sweeps[0].facts.flags, lidar::kSweepPartial);
}

TEST(LoadSweeps, WrongFactoryByte_IsFlaggedAndNamed) {
  auto sent = packets(80);
  for (Vlp16Packet& packet : sent) packet[1205] = std::byte{0x21};
  const Recording recording = load(pcap(sent));
  EXPECT_NE(all_flags(recording) & lidar::kSweepOtherSensor, 0U);
  EXPECT_EQ(all_flags(recording) & lidar::kSweepWrongTiming, 0U);
  ASSERT_FALSE(recording.report.warnings.empty());
  EXPECT_TRUE(contains(recording.report.warnings[0], "factory byte 0x21"));
}

TEST(LoadSweeps, WrongModel_IsRefusedWithTheRightOne) {
  const auto sent = packets(80);
  const auto says = [&](const std::string& model, const std::string& part) {
    const std::string got = refusal([&] { static_cast<void>(load(pcap(sent), model)); });
    EXPECT_TRUE(contains(got, "a.pcap") && contains(got, part)) << got;
  };
  says("hdl32e", "use --sensor vlp16");
  says("vlp32c", "use --sensor vlp16");
  says("helios16p", "use --sensor vlp16");
  says("mid360", "use --sensor vlp16");
  says("r2000", "none a point packet of a Pepperl+Fuchs R2000");
  const std::string unknown = refusal([&] { static_cast<void>(load(pcap(sent), "vlp99")); });
  EXPECT_TRUE(contains(unknown, "no such LiDAR; one of: vlp16")) << unknown;
  EXPECT_TRUE(contains(refusal([&] { static_cast<void>(load(pcap(sent), "")); }), "give --sensor"));
}

TEST(LoadSweeps, ModelWithNeitherByteNorPace_IsFlagged) {
  auto sent = packets(80);  // the byte of a VLP-32C, the pace of a VLP-16
  for (Vlp16Packet& packet : sent) packet[1205] = std::byte{0x28};
  const Recording recording = load(pcap(sent), "vlp32c");
  EXPECT_NE(all_flags(recording) & lidar::kSweepWrongTiming, 0U);
  EXPECT_TRUE(contains(recording.report.warnings[0], "pace"));
}

TEST(LoadSweeps, FlippedBits_NeverPassWithoutCount) {
  const auto sent = packets(80);
  truth::Random random(5);
  for (int trial = 0; trial < 200; ++trial) {
    auto damaged = sent;
    Vlp16Packet& packet = damaged[10 + random.below(50)];
    // Marks, azimuths, stamp's upper half and mode: what is not a measurement.
    const std::size_t block = random.below(12);
    const std::array<std::size_t, 4> places = {block * 100, block * 100 + 1, block * 100 + 3, 1203};
    const std::size_t at = places[random.below(places.size())];
    packet[at] ^= static_cast<std::byte>(0x20 << random.below(3));
    const Recording recording = load(pcap(damaged));
    const bool flagged = (all_flags(recording) & ~uint32_t{lidar::kSweepPartial}) != 0;
    EXPECT_TRUE(flagged || recording.report.counters.restarts > 0) << "byte " << at;
  }
}

TEST(LoadSweeps, PcapOfSomethingElse_IsNamed) {
  const std::vector<std::vector<std::byte>> chatter(20, std::vector<std::byte>(90, std::byte{'x'}));
  const std::string got = refusal([&] { static_cast<void>(load(pcap(chatter))); });
  EXPECT_TRUE(contains(got, "20 UDP datagrams, none a point packet of a Velodyne VLP-16")) << got;
  const std::vector<std::vector<std::byte>> large(20, std::vector<std::byte>(1206, std::byte{'x'}));
  EXPECT_TRUE(contains(refusal([&] { static_cast<void>(load(pcap(large))); }), "20 refused"));
}

TEST(LoadSweeps, TruncatedPackets_AreRefusedByReason) {
  std::vector<std::vector<std::byte>> sent;
  for (const Vlp16Packet& packet : packets(90)) sent.emplace_back(packet.begin(), packet.end());
  sent[40].resize(900);
  const Recording recording = load(pcap(sent));
  EXPECT_EQ(recording.report.refused.at("a Velodyne point packet has 1206 bytes"), 1U);
  EXPECT_NE(recording.sweeps[0].facts.flags & lidar::kSweepBadPackets, 0U);
}

TEST(LoadSweeps, MaxSweeps_StopsThere) {
  LoadRequest request;
  request.model = "vlp16";
  request.max_sweeps = 1;
  EXPECT_EQ(load_sweeps("a.pcap", pcap(packets(300)), request).sweeps.size(), 1U);
}

TEST(LoadSweeps, SmallCapacity_IsFlaggedFull) {
  LoadRequest request;
  request.model = "vlp16";
  request.options.capacity = 5000;
  const Recording recording = load_sweeps("a.pcap", pcap(packets(160)), request);
  EXPECT_EQ(recording.sweeps[0].points.size(), 5000U);
  EXPECT_NE(recording.sweeps[0].facts.flags & lidar::kSweepFull, 0U);
  EXPECT_EQ(recording.sweeps[1].points.size(), 5000U);
  EXPECT_GT(recording.report.counters.dropped_points, 40'000U);
}

}  // namespace
}  // namespace roomcal::tools
