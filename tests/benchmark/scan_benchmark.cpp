// One VLP-16 sweep of 28,800 points located in a room of ten planes: by ray casting, and the paper's way.
#include <vector>

#include <benchmark/benchmark.h>

#include "runtime/scan/locate_by_gicp.h"
#include "tools/evaluate/lidar_trial.h"

namespace roomcal::scan {
namespace {

struct Shot {
  Shot() {
    tools::SweepFlaws flaws;
    tools::Random random(3);
    for (int i = 0; i < 16; ++i) flaws.beam_offset_m.push_back(0.01 * random.normal());
    sweep = room.simulator().sweep(tools::vlp16_beams(), flaws, T_room_lidar, 5);
    view = sweep.view();
    prior.T_room_lidar = T_room_lidar * se3_exp((Vec6() << 0.1, -0.15, 0.08, 0.1, -0.1, 0.1).finished());
    prior.cov = 0.02 * Mat66::Identity();
  }

  tools::LidarRoom room{7};
  SE3 T_room_lidar{so3_exp(Vec3(0.25, 0.15, 0.7)), Vec3(1.1, 1.6, 1.2)};
  tools::SimulatedSweep sweep;
  lidar::Sweep view;
  PosePrior prior;
};

const Shot& shot() {
  static const Shot shot;
  return shot;
}

void report(benchmark::State& state, const Location& location, std::size_t scratch_bytes) {
  if (location.outcome != LocateOutcome::kLocated) state.SkipWithError(location.reason);
  state.counters["error_mm"] = 1e3 * (location.T_room_lidar.t - shot().T_room_lidar.t).norm();
  state.counters["state_KiB"] = static_cast<double>(scratch_bytes + sizeof(Location)) / 1024;
}

void locate_sweep(benchmark::State& state) {
  std::vector<std::byte> bytes(locate_scratch_bytes());
  Arena scratch{bytes};
  Location location;
  for (auto _ : state) {
    const Status status = locate(shot().room.surface(), {&shot().view, 1}, {}, &shot().prior, {}, scratch, location);
    if (!status.ok()) state.SkipWithError(status.detail());
  }
  report(state, location, bytes.size());
}
BENCHMARK(locate_sweep)->Unit(benchmark::kMillisecond);

void locate_sweep_by_gicp(benchmark::State& state) {
  std::vector<std::byte> bytes(locate_by_gicp_scratch_bytes());
  Arena scratch{bytes};
  Location location;
  for (auto _ : state) {
    const Status status = locate_by_gicp(shot().room.surface(), shot().room.dense(), {&shot().view, 1}, {},
                                         &shot().prior, {}, {}, scratch, location);
    if (!status.ok()) state.SkipWithError(status.detail());
  }
  report(state, location, bytes.size());
}
BENCHMARK(locate_sweep_by_gicp)->Unit(benchmark::kMillisecond);

void build_kd_tree(benchmark::State& state) {
  const std::span<const Eigen::Vector3f> points = shot().room.dense().points_room();
  std::vector<std::byte> bytes(KdTree::bytes(points.size()));
  for (auto _ : state) {
    Arena arena{bytes};
    benchmark::DoNotOptimize(KdTree::build(points, arena).ok());
  }
  state.counters["points"] = static_cast<double>(points.size());
}
BENCHMARK(build_kd_tree)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace roomcal::scan
