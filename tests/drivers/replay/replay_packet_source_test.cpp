#include "drivers/replay/replay_packet_source.h"

#include <optional>
#include <string>

#include "tests/drivers/replay/replay_folder.h"
#include "tests/fakes/manual_clocks.h"

namespace roomcal::drivers {
namespace {

constexpr int64_t kMillisecond_ns = 1'000'000;
constexpr int64_t kRecorded_us = 1'700'000'000'000'000;

struct Seen final : ports::PacketVisitor {
  void take(const ports::Packet& packet) override {
    values.push_back(std::to_integer<int>(packet.payload[0]));
    arrived.push_back(packet.arrived);
  }
  std::vector<int> values;
  std::vector<Stamp> arrived;
};

std::vector<int64_t> every_10_ms(int count) {
  std::vector<int64_t> stamps;
  for (int i = 0; i < count; ++i) stamps.push_back(kRecorded_us + 10'000 * i);
  return stamps;
}

class ReplayPacketTest : public test::ReplayFolder {
 protected:
  Status start(ReplayPacketOptions options = {}) {
    options.name = "lidar0";
    EXPECT_TRUE(cursor_.open(path(), clocks_.now_ns()).ok());
    memory_.resize(ReplayPacketSource::memory_bytes(options, cursor_));
    source_.emplace(options, cursor_, clocks_, memory_);
    const Status started = source_->start();
    started_ns_ = clocks_.now_ns();
    return started;
  }
  // Drains every millisecond.
  void run(int64_t milliseconds) {
    for (int64_t i = 0; i < milliseconds; ++i) {
      source_->drain(seen_);
      clocks_.advance(kMillisecond_ns);
    }
  }

  fakes::ManualClocks clocks_;
  ReplayCursor cursor_;
  std::vector<std::byte> memory_;
  std::optional<ReplayPacketSource> source_;
  int64_t started_ns_ = 0;
  Seen seen_;
};

TEST_F(ReplayPacketTest, Packets_ComeAtTheRecordingsPaceStampedNow) {
  write_pcap("lidar0.pcap", {kRecorded_us, kRecorded_us + 10'000, kRecorded_us + 15'000, kRecorded_us + 99'000}, 1);
  ASSERT_TRUE(start().ok());
  run(50);
  EXPECT_EQ(seen_.values, (std::vector{1, 2, 3}));
  run(50);
  EXPECT_EQ(seen_.values, (std::vector{1, 2, 3, 4}));
  const std::vector<int64_t> offsets_ms = {0, 10, 15, 99};
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(seen_.arrived[i], (Stamp{started_ns_ + offsets_ms[i] * kMillisecond_ns, ClockId::kMonotonic}));
  EXPECT_EQ(source_->counters().delivered, 4U);
  EXPECT_EQ(source_->counters().kernel_drops, 0U);
}

TEST_F(ReplayPacketTest, LoopsEndAfterWholeTurns) {
  write_pcap("lidar0.pcap", every_10_ms(25), 0);  // two turns and a half
  ASSERT_TRUE(start().ok());
  run(600);
  std::vector<int> expected;
  for (int i = 0; i < 60; ++i) expected.push_back(i % 20);
  EXPECT_EQ(seen_.values, expected);
  EXPECT_EQ(seen_.arrived[20].ns - seen_.arrived[19].ns, 10 * kMillisecond_ns) << "the pace goes on over the seam";
}

TEST_F(ReplayPacketTest, TurnThatMissesSomeMicroseconds_IsWhole) {
  std::vector<int64_t> stamps = every_10_ms(20);
  stamps.back() -= 300;
  write_pcap("lidar0.pcap", stamps, 0);
  ASSERT_TRUE(start().ok());
  run(400);
  EXPECT_EQ(seen_.values.size(), 40U);
}

TEST_F(ReplayPacketTest, LessThanATurn_IsLoopedAsItIs) {
  write_pcap("lidar0.pcap", every_10_ms(5), 0);
  ASSERT_TRUE(start().ok());
  run(200);
  EXPECT_EQ(seen_.values.size(), 20U);
}

TEST_F(ReplayPacketTest, OnePacket_ComesOnceAMillisecondAtMost) {
  write_pcap("lidar0.pcap", {kRecorded_us}, 7);
  ASSERT_TRUE(start().ok());
  run(10);
  EXPECT_LE(seen_.values.size(), 11U);
}

TEST_F(ReplayPacketTest, OtherPorts_AreLeftOut) {
  write_pcap("lidar0.pcap", every_10_ms(5), 0, 8308);
  EXPECT_EQ(start({.port = 2368}).code(), StatusCode::kUnavailable);
  ASSERT_TRUE(start({.port = 8308}).ok());
  ASSERT_TRUE(start({.port = 0}).ok());
}

TEST_F(ReplayPacketTest, ReaderWhoStaysAway_LosesAndKnows) {
  write_pcap("lidar0.pcap", every_10_ms(20), 0);
  ASSERT_TRUE(start().ok());
  run(50);
  clocks_.advance(255 * kMillisecond_ns);
  run(1);
  EXPECT_EQ(source_->counters().delivered, seen_.values.size());
  EXPECT_EQ(source_->counters().delivered + source_->counters().kernel_drops, 31U);
  EXPECT_GT(source_->counters().kernel_drops, 10U);
  EXPECT_GE(seen_.arrived[5].ns, started_ns_ + 200 * kMillisecond_ns) << "what waits for longer than a stall is gone";
}

TEST_F(ReplayPacketTest, ReaderWhoStaysAwayForADay_IsBackAtOnce) {
  write_pcap("lidar0.pcap", every_10_ms(20), 0);
  ASSERT_TRUE(start().ok());
  constexpr int64_t kDay_ms = 24 * 3600 * 1000;
  clocks_.advance(kDay_ms * kMillisecond_ns);
  source_->drain(seen_);
  EXPECT_EQ(seen_.values.size(), 11U);
  EXPECT_EQ(source_->counters().delivered + source_->counters().kernel_drops, static_cast<uint64_t>(kDay_ms) / 10 + 1);
  EXPECT_EQ(seen_.arrived.back().ns, clocks_.now_ns());
}

TEST_F(ReplayPacketTest, BoardGoesOn_TheNextRecordingBegins) {
  write_pcap("shot000/lidar0.pcap", every_10_ms(20), 0);
  write_pcap("shot001/lidar0.pcap", every_10_ms(20), 100);
  ASSERT_TRUE(start().ok());
  run(35);
  EXPECT_EQ(seen_.values, (std::vector{0, 1, 2, 3}));
  cursor_.advance(clocks_.now_ns());
  run(25);
  EXPECT_EQ(seen_.values, (std::vector{0, 1, 2, 3, 100, 101, 102}));
  cursor_.advance(clocks_.now_ns());
  run(5);
  EXPECT_EQ(seen_.values.back(), 0) << "each shot begins at its beginning";
}

TEST_F(ReplayPacketTest, PacketsRecordedOutOfOrder_ComeInTheFilesOrder) {
  write_pcap("lidar0.pcap",
             {kRecorded_us, kRecorded_us + 20'000, kRecorded_us + 10'000, kRecorded_us - 5'000, kRecorded_us + 95'000},
             0);
  ASSERT_TRUE(start().ok());
  run(99);
  EXPECT_EQ(seen_.values, (std::vector{0, 1, 2, 3, 4}));
}

TEST_F(ReplayPacketTest, UnfitRecordings_AreNamed) {
  const auto says = [&](const std::string& part) {
    const Status started = start();
    EXPECT_EQ(started.code(), StatusCode::kUnavailable);
    EXPECT_NE(std::string(started.detail()).find(part), std::string::npos) << started.detail();
    EXPECT_EQ(source_->drain(seen_), 0U);
  };
  says("no .pcap");
  write("lidar0.pcap", "");
  says("too short");
  write("lidar0.pcap", "a list of things that are no recording");
  says("no pcap");
  write_pcap("lidar0.pcap", {}, 0);
  says("no packet");
}

TEST_F(ReplayPacketTest, TooLittleMemory_IsRefusedForEverySize) {
  write_pcap("shot000/lidar0.pcap", every_10_ms(2), 0);
  write_pcap("shot001/lidar0.pcap", every_10_ms(2), 0);
  ASSERT_TRUE(start().ok());
  const std::size_t needed = memory_.size() - 2 * alignof(std::max_align_t);  // the allowance for alignment
  for (const std::size_t size : {std::size_t{0}, std::size_t{1000}, needed / 2, needed - 100, needed - 1}) {
    ReplayPacketSource source({"lidar0"}, cursor_, clocks_, std::span(memory_).first(size));
    EXPECT_EQ(source.start().code(), StatusCode::kOutOfMemory) << size;
    EXPECT_EQ(source.drain(seen_), 0U);
  }
}

TEST_F(ReplayPacketTest, StoppedAndStarted_BeginsAnew) {
  write_pcap("lidar0.pcap", every_10_ms(20), 0);
  ASSERT_TRUE(start().ok());
  run(55);
  source_->stop();
  EXPECT_EQ(source_->drain(seen_), 0U);
  ASSERT_TRUE(source_->start().ok());
  EXPECT_EQ(source_->counters().delivered, 0U);
  seen_ = {};
  run(5);
  EXPECT_EQ(seen_.values, (std::vector{0}));
}

}  // namespace
}  // namespace roomcal::drivers
