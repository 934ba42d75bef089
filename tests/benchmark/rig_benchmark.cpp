#include <vector>

#include <benchmark/benchmark.h>

#include "tests/runtime/rig/shot.h"

namespace roomcal::rig {
namespace {

// The robot: four wide cameras, 75 markers each. Arguments: cameras, sigma of the map in millimetres.
void solve_robot_shot(benchmark::State& state) {
  truth::Random random(1);
  const auto room = truth::make_room(random);
  test::ShotOptions options;
  options.cameras = static_cast<std::size_t>(state.range(0));
  options.max_observations = 75;
  const double map_sigma_m = 1e-3 * static_cast<double>(state.range(1));
  options.map_cov_m2 = map_sigma_m * map_sigma_m * Mat33::Identity();
  const test::Shot shot = test::make_shot(random, room, options);
  const std::vector<CameraView> views = shot.views();
  std::vector<std::byte> scratch_bytes(
      solve_scratch_bytes(views.size(), shot.observation_count(), shot.landmarks.size()));
  std::vector<std::byte> step_bytes(solve_step_bytes(views.size()));
  RigSolution solution;
  for (auto _ : state) {
    Arena scratch{scratch_bytes}, step{step_bytes};
    const Status status = solve_cameras(views, shot.landmarks, {}, step, scratch, solution);
    if (!status.ok()) state.SkipWithError(status.detail());
    benchmark::DoNotOptimize(solution);
  }
  state.counters["observations"] = static_cast<double>(shot.observation_count());
  state.counters["iterations"] = solution.iterations;
  state.counters["scratch_bytes"] = static_cast<double>(scratch_bytes.size());
}
BENCHMARK(solve_robot_shot)
    ->ArgNames({"cameras", "map_sigma_mm"})
    ->Args({4, 0})
    ->Args({4, 5})
    ->Args({8, 0})
    ->Args({8, 5})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace roomcal::rig
