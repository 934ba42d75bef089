#include "tools/evaluate/paper_runs.h"

#include <cmath>
#include <mutex>

#include "tools/map/noise.h"
#include "tools/simulate/raster.h"

namespace roomcal::tools {

namespace {

MapData with_noise(MapData data, double sigma_m, uint64_t seed, bool declared) {
  if (sigma_m <= 0) return data;
  add_noise(data, sigma_m, seed, declared);
  return data;
}

}  // namespace

PaperRooms::PaperRooms(int count) {
  rooms_.resize(static_cast<std::size_t>(count));
  parallel_for(count, [&](int i) {
    rooms_[static_cast<std::size_t>(i)] = std::make_unique<TrustRoom>(static_cast<uint64_t>(i) + 1);
  });
}

std::vector<PaperTrial> run_paper_trials(const PaperRooms& rooms, const std::string& device, int count,
                                         double map_sigma_m, bool declared) {
  std::vector<PaperTrial> trials(static_cast<std::size_t>(count));
  Progress progress(map_sigma_m > 0 ? device + ", noisy map" : device, trials.size());
  std::mutex progress_mutex;
  parallel_for(count, [&](int i) {
    const uint64_t seed = static_cast<uint64_t>(i) + 1;
    const TrustRoom& room = rooms.of(seed);
    trials[static_cast<std::size_t>(i)] =
        run_paper_trial(room, with_noise(room.data(), map_sigma_m, seed, declared), map_sigma_m, device, seed);
    const std::lock_guard lock(progress_mutex);
    progress.step();
  });
  return trials;
}

PaperPair pair_over(const std::vector<PaperTrial>& trials, const std::string& to, const std::string& from,
                    bool accepted_only) {
  PaperPair tally;
  tally.to = to;
  tally.from = from;
  for (const PaperTrial& trial : trials) {
    ++tally.shots;
    const PairError* pair = trial.find(to, from);
    if (pair == nullptr) continue;
    tally.accepted += trial.accepted() ? 1 : 0;
    tally.wrong += trial.accepted() && pair->wrong() ? 1 : 0;
    if (accepted_only && !trial.accepted()) continue;
    tally.position_m.push_back(pair->position_m);
    tally.rotation_rad.push_back(pair->rotation_rad);
    tally.seen_position_m.push_back(pair->seen_position_m);
    tally.seen_rotation_rad.push_back(pair->seen_rotation_rad);
    tally.baseline_m.push_back(pair->baseline_m);
    tally.nees.push_back(pair->nees);
  }
  return tally;
}

}  // namespace roomcal::tools
