// Cost of a LiDAR's packets on one core: decoding alone, and cutting sweeps. Bytes are a VLP-16's, made here.
#include <vector>

#include <benchmark/benchmark.h>

#include "runtime/lidar/sweep_builder.h"
#include "tests/truth/lidar_box.h"

namespace roomcal::lidar {
namespace {

std::vector<tools::Vlp16Packet> packets(uint8_t return_mode) {
  tools::Vlp16Stream stream;
  stream.return_mode = return_mode;
  const std::size_t firings = return_mode == kVelodyneDual ? 12 : 24, turns = 10;
  const auto returns = truth::box_returns(stream, turns * stream.firings_per_turn(), {-1, -2, -1}, {2, 2, 1});
  std::vector<tools::Vlp16Packet> result;
  for (std::size_t first = 0; (first + firings) * tools::kVlp16Lasers <= returns.size(); first += firings)
    result.push_back(make_vlp16_packet(stream, first, std::span(returns).subspan(first * tools::kVlp16Lasers)));
  return result;
}

/// Argument: 1 for dual return (equal ranges: half of the work gives no points).
void decode_vlp16(benchmark::State& state) {
  const auto sent = packets(state.range(0) != 0 ? kVelodyneDual : kVelodyneStrongest);
  const Calibration calibration = built_in_calibration(Model::kVlp16).value();
  std::vector<SweepPoint> points(kMaxPacketPoints);
  std::size_t decoded_points = 0;
  for (auto _ : state) {
    for (const tools::Vlp16Packet& packet : sent) {
      PacketHeader header;
      DecodedPacket decoded;
      if (!inspect_packet(calibration, packet, header).ok() ||
          !decode_packet(calibration, header, packet, 0, points, decoded).ok())
        state.SkipWithError("refused");
      decoded_points += decoded.point_count;
      benchmark::DoNotOptimize(points.data());
    }
  }
  state.counters["ns_per_point"] = benchmark::Counter(1e-9 * static_cast<double>(decoded_points),
                                                      benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(decode_vlp16)->ArgName("dual")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

void build_sweeps_vlp16(benchmark::State& state) {
  const auto sent = packets(kVelodyneStrongest);
  const Calibration calibration = built_in_calibration(Model::kVlp16).value();
  const SweepOptions options = {.capacity = 32'000};
  std::vector<std::byte> memory(SweepBuilder::arena_bytes(options));
  std::size_t points = 0;
  for (auto _ : state) {
    Arena arena(memory);
    SweepBuilder builder = SweepBuilder::create(calibration, options, arena).value();
    for (const tools::Vlp16Packet& packet : sent)
      if (!builder.push(packet).ok()) state.SkipWithError("refused");
    points += builder.counters().points;
  }
  state.counters["state_bytes"] = static_cast<double>(sizeof(SweepBuilder));
  state.counters["ns_per_point"] =
      benchmark::Counter(1e-9 * static_cast<double>(points), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(build_sweeps_vlp16)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace roomcal::lidar
