// The state table of sweep_builder.h, row by row. Recordings with faults: tests/tools/sweep/load_sweeps_test.cpp.
#include "runtime/lidar/sweep_builder.h"

#include <vector>

#include <gtest/gtest.h>

#include "runtime/lidar/r2000.h"
#include "tests/runtime/lidar/packet_bytes.h"
#include "tests/truth/lidar_box.h"

namespace roomcal::lidar {
namespace {

constexpr std::size_t kPerTurn = 75;  // packets of a VLP-16 turn at 10 Hz, and a third

/// A VLP-16 turning in a box; packet i of an endless stream.
class Stream {
 public:
  Stream() {
    stream_.first_azimuth_rad = 1;
    stream_.first_ns = 10'000'000'000;
    returns_ = truth::box_returns(stream_, 400 * tools::kVlp16FiringsPerPacket, {-1, -2, -1}, {2, 2, 1});
  }
  tools::Vlp16Packet packet(std::size_t i) const {
    const std::size_t first = i * tools::kVlp16FiringsPerPacket;
    return tools::make_vlp16_packet(stream_, first, std::span(returns_).subspan(first * tools::kVlp16Lasers));
  }

 private:
  tools::Vlp16Stream stream_;
  std::vector<tools::Vlp16Return> returns_;
};

/// A builder with its memory, collecting what it completes.
class Bench {
 public:
  explicit Bench(const SweepOptions& options = {}, Model model = Model::kVlp16)
      : calibration_(built_in_calibration(model).value()),
        memory_(SweepBuilder::arena_bytes(options)),
        arena_(memory_),
        builder(SweepBuilder::create(calibration_, options, arena_).value()) {}

  Status push(Bytes packet) {
    const Status status = builder.push(packet);
    keep();
    return status;
  }
  void finish() {
    builder.finish();
    keep();
  }
  std::vector<Sweep> sweeps;  ///< without points
  std::vector<std::size_t> points;

 private:
  void keep() {
    if (!builder.ready()) return;
    sweeps.push_back(builder.sweep());
    points.push_back(builder.sweep().points.size());
    check_points(builder.sweep());
    sweeps.back().points = {};
  }
  static void check_points(const Sweep& sweep) {
    for (const SweepPoint& p : sweep.points) {
      ASSERT_GE(p.offset_ns, 0);
      ASSERT_LE(p.offset_ns, sweep.duration_ns);
      ASSERT_LT(p.beam, sweep.beam_count);
    }
  }

  Calibration calibration_;
  std::vector<std::byte> memory_;
  Arena arena_;

 public:
  SweepBuilder builder;
};

TEST(SweepBuilder, TurnsFromTheFirstAzimuth_AreWhole) {
  const Stream stream;
  Bench bench;
  for (std::size_t i = 0; i < 3 * kPerTurn + 20; ++i) ASSERT_TRUE(bench.push(stream.packet(i)).ok());
  bench.finish();
  ASSERT_EQ(bench.sweeps.size(), 4U);
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_EQ(bench.sweeps[k].flags, 0U);
    EXPECT_NEAR(static_cast<double>(bench.points[k]), 28'928, 64);
    EXPECT_NEAR(static_cast<double>(bench.sweeps[k].duration_ns), 1e8, 1e6);
    EXPECT_NEAR(static_cast<double>(bench.sweeps[k].stamp.ns), 1e10 + 1e8 * i, 2e5);
  }
  EXPECT_EQ(bench.sweeps[3].flags, kSweepPartial);
  std::size_t points = 0;
  for (const std::size_t n : bench.points) points += n;
  EXPECT_EQ(points, (3 * kPerTurn + 20) * 384) << "no point is lost at a cut";
}

TEST(SweepBuilder, CutAtAFixedAzimuth_BeginsWithAPartialOne) {
  const Stream stream;
  Bench bench({.cut_cdeg = 0});
  for (std::size_t i = 0; i < 2 * kPerTurn; ++i) ASSERT_TRUE(bench.push(stream.packet(i)).ok());
  ASSERT_EQ(bench.sweeps.size(), 2U);
  EXPECT_EQ(bench.sweeps[0].flags, kSweepPartial);
  EXPECT_EQ(bench.sweeps[1].flags, 0U);
}

TEST(SweepBuilder, Pause_SplitsIntoTwoPartialSweeps) {
  const Stream stream;
  Bench bench;
  for (std::size_t i = 0; i < kPerTurn; ++i)
    if (i < 20 || i >= 50) {
      ASSERT_TRUE(bench.push(stream.packet(i)).ok());
    }
  bench.finish();
  ASSERT_EQ(bench.sweeps.size(), 2U);
  EXPECT_EQ(bench.sweeps[0].flags, kSweepPartial | kSweepLostPackets);
  EXPECT_NE(bench.sweeps[1].flags & kSweepPartial, 0U);
  EXPECT_EQ(bench.builder.counters().lost, 30U);
}

TEST(SweepBuilder, LatePacketOfAClosedSweep_IsDroppedAndCounted) {
  const Stream stream;
  Bench bench;
  for (std::size_t i = 0; i < kPerTurn + 10; ++i)
    if (i != 70) {
      ASSERT_TRUE(bench.push(stream.packet(i)).ok());
    }
  ASSERT_TRUE(bench.push(stream.packet(70)).ok());
  bench.finish();
  EXPECT_EQ(bench.builder.counters().late_dropped, 1U);
  EXPECT_EQ(bench.sweeps[0].flags, kSweepLostPackets);
  EXPECT_NE(bench.sweeps[1].flags & kSweepOutOfOrder, 0U);
}

TEST(SweepBuilder, ClockThatJumps_StartsAgain) {
  const Stream stream;
  Bench bench;
  for (std::size_t i = 0; i < 20; ++i) ASSERT_TRUE(bench.push(stream.packet(i)).ok());
  for (std::size_t i = 200; i < 220; ++i) {
    tools::Vlp16Packet packet = stream.packet(i);
    packet[1203] = std::byte{0x40};  // eighteen minutes later
    ASSERT_TRUE(bench.push(packet).ok());
  }
  bench.finish();
  EXPECT_EQ(bench.builder.counters().restarts, 1U);
  EXPECT_EQ(bench.sweeps.size(), 2U);
  EXPECT_EQ(bench.sweeps[0].flags & kSweepPartial, kSweepPartial);
}

TEST(SweepBuilder, RecordingOfWholeTurnsThatStartsOver_GivesWholeSweepsOnly) {
  const Stream stream;
  Bench bench;
  constexpr std::size_t kThreeTurns = 3 * kPerTurn + 1;
  for (int round = 0; round < 3; ++round)
    for (std::size_t i = 0; i < kThreeTurns; ++i) ASSERT_TRUE(bench.push(stream.packet(i)).ok());
  bench.finish();
  EXPECT_EQ(bench.builder.counters().restarts, 2U);
  EXPECT_EQ(bench.builder.counters().late_dropped + bench.builder.counters().late_used, 0U);
  ASSERT_EQ(bench.sweeps.size(), 9U);
  for (const Sweep& sweep : bench.sweeps) EXPECT_EQ(sweep.flags, 0U);
}

TEST(SweepBuilder, HeadThatStands_EndsSweepsAfterTwoSeconds) {
  const Stream stream;
  Bench bench({.capacity = 2'000'000});
  for (std::size_t i = 0; i < 2000; ++i) {
    tools::Vlp16Packet packet = stream.packet(3);
    for (std::size_t block = 1; block < 12; ++block)
      std::copy_n(packet.begin() + 2, 2, packet.begin() + static_cast<std::ptrdiff_t>(block * 100 + 2));
    const auto us = static_cast<uint32_t>(10'000'000 + 1327 * i);
    for (std::size_t b = 0; b < 4; ++b) packet[1200 + b] = static_cast<std::byte>(us >> (8 * b));
    ASSERT_TRUE(bench.push(packet).ok());
  }
  ASSERT_EQ(bench.sweeps.size(), 1U);
  EXPECT_EQ(bench.sweeps[0].flags, kSweepPartial);
}

TEST(SweepBuilder, TurnsByNumber_AreCutAndCountedByNumber) {
  const auto scan = [](uint16_t number, std::size_t part) {
    test::PacketBytes bytes(kR2000HeadBytes + 4 * 100);
    bytes.le(0, 0xA25C, 2);
    bytes.le(2, 'A', 2);
    bytes.le(4, kR2000HeadBytes + 400, 4);
    bytes.le(8, kR2000HeadBytes, 2);
    bytes.le(10, number, 2);
    bytes.le(14, (uint64_t{number} << 32) / 16 + part * 1'000'000, 8);
    bytes.le(34, 16'000, 4);
    bytes.le(38, 300, 2);
    bytes.le(40, 100, 2);
    bytes.le(42, 100 * part, 2);
    bytes.le(48, 12'000, 4);
    for (std::size_t i = 0; i < 100; ++i) bytes.le(kR2000HeadBytes + 4 * i, 1500, 4);
    return bytes;
  };
  Bench bench({}, Model::kR2000);
  for (uint16_t number = 5; number < 9; ++number)
    for (std::size_t part = 0; part < 3; ++part) {
      if ((number == 5 && part == 0) || (number == 7 && part == 1)) continue;
      ASSERT_TRUE(bench.push(scan(number, part).view()).ok());
    }
  bench.finish();
  ASSERT_EQ(bench.sweeps.size(), 4U);
  EXPECT_EQ(bench.sweeps[0].flags, kSweepPartial) << "the recording begins within it";
  EXPECT_EQ(bench.sweeps[1].flags, 0U);
  EXPECT_EQ(bench.sweeps[2].flags, kSweepLostPackets);
  EXPECT_EQ(bench.sweeps[3].flags, 0U);
}

TEST(SweepBuilder, Options_AreChecked) {
  const Calibration calibration = built_in_calibration(Model::kVlp16).value();
  std::vector<std::byte> memory(1000);
  Arena small(memory);
  EXPECT_EQ(SweepBuilder::create(calibration, {}, small).status().code(), StatusCode::kOutOfMemory);
  EXPECT_EQ(SweepBuilder::create(calibration, {.capacity = 0}, small).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(SweepBuilder::create(calibration, {.cut_cdeg = 36000}, small).status().code(),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(SweepBuilder::create(calibration, {.period_ns = 0}, small).status().code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace roomcal::lidar
