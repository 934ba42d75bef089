// A simulated recording, played in a loop: its sweeps are those of the file, turn for turn.

#include <vector>

#include "drivers/replay/replay_packet_source.h"
#include "runtime/lidar/sweep_builder.h"
#include "tests/drivers/replay/replay_folder.h"
#include "tests/fakes/manual_clocks.h"
#include "tests/truth/lidar_box.h"
#include "tools/sweep/load_sweeps.h"

namespace roomcal::drivers {
namespace {

constexpr int64_t kMillisecond_ns = 1'000'000;

class Collect final : public ports::PacketVisitor {
 public:
  Collect()
      : calibration_(lidar::built_in_calibration(lidar::Model::kVlp16).value()),
        bytes_(lidar::SweepBuilder::arena_bytes({})),
        arena_(bytes_),
        builder_(lidar::SweepBuilder::create(calibration_, {}, arena_).value()) {}
  void take(const ports::Packet& packet) override {
    ASSERT_TRUE(builder_.push(packet.payload).ok());
    if (!builder_.ready()) return;
    const lidar::Sweep& sweep = builder_.sweep();
    ++((sweep.flags == 0) ? whole : flagged);
    if (sweep.flags == 0) points.emplace_back(sweep.points.begin(), sweep.points.end());
  }
  int whole = 0, flagged = 0;
  std::vector<std::vector<lidar::SweepPoint>> points;

 private:
  lidar::Calibration calibration_;
  std::vector<std::byte> bytes_;
  Arena arena_;
  lidar::SweepBuilder builder_;
};

class ReplaySweeps : public test::ReplayFolder {
 protected:
  static constexpr int kTurns = 4;

  std::vector<std::byte> record() const {
    tools::Vlp16Stream stream;
    stream.first_azimuth_rad = 1;
    const std::size_t firings = kTurns * stream.firings_per_turn() + tools::kVlp16FiringsPerPacket;
    return tools::make_vlp16_pcap(stream, truth::box_returns(stream, firings, {-1, -2, -1}, {2, 2, 1}),
                                  1'700'000'000'000'000'000);
  }
};

TEST_F(ReplaySweeps, PlayedInALoop_EveryTurnIsTheFilesTurn) {
  const std::vector<std::byte> pcap = record();
  write("lidar0.pcap", std::string(reinterpret_cast<const char*>(pcap.data()), pcap.size()));
  const tools::Recording file =
      tools::load_sweeps("recording", pcap, {.file = {}, .model = "vlp16", .calibration = {}});
  fakes::ManualClocks clocks;
  ReplayCursor cursor;
  ASSERT_TRUE(cursor.open(path(), clocks.now_ns()).ok());
  const ReplayPacketOptions options = {"lidar0", 2368};
  std::vector<std::byte> memory(ReplayPacketSource::memory_bytes(options, cursor));
  ReplayPacketSource source(options, cursor, clocks, memory);
  ASSERT_TRUE(source.start().ok());
  Collect collect;
  constexpr int kLoops = 5;
  for (int i = 0; i <= kLoops * kTurns * 100; ++i, clocks.advance(kMillisecond_ns)) source.drain(collect);
  EXPECT_EQ(collect.whole, kLoops * kTurns);
  EXPECT_LE(collect.flagged, kLoops) << "the packet across each seam";
  for (std::size_t i = 0; i < collect.points.size(); ++i) {
    const std::vector<lidar::SweepPoint>& expected = file.sweeps[i % kTurns].points;
    ASSERT_EQ(collect.points[i].size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) ASSERT_EQ(collect.points[i][k].range_m, expected[k].range_m);
  }
  EXPECT_EQ(source.counters().kernel_drops, 0U);
}

}  // namespace
}  // namespace roomcal::drivers
