#include "tools/evaluate/lidar_bars.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include <fmt/core.h>

namespace roomcal::tools {

namespace {

constexpr double kCautious = 3;

/// An axis is called open though the bound calls it seen: the few returns that would fix it (a strip of floor at a
/// wall's foot) can as well be explained without it, which a bound made of derivatives does not know.
bool is_cautious(const LidarTrial& trial) {
  for (const scan::WeakDirection& weak : trial.location.weak) {
    const double bound = weak.rotation ? trial.bound.rotation_rad : trial.bound.position_m;
    if (weak.sigma > kCautious * bound) return true;
  }
  return false;
}

LidarCell pooled(const std::vector<LidarCell>& cells, LidarAid aid) {
  LidarCell sum;
  for (const LidarCell& cell : cells) {
    if (cell.aid != aid) continue;
    sum.poses += cell.poses;
    sum.observable += cell.observable;
    sum.found += cell.found;
    sum.unobservable += cell.unobservable;
    sum.missed += cell.missed;
    sum.closed += cell.closed;
    sum.closed_squares_m2 += cell.closed_squares_m2;
    sum.closed_nees += cell.closed_nees;
    sum.ambiguous += cell.ambiguous;
    sum.refused += cell.refused;
    sum.wrong += cell.wrong;
    sum.cautious += cell.cautious;
    sum.position_squares += cell.position_squares;
    sum.rotation_squares += cell.rotation_squares;
    sum.nees += cell.nees;
    sum.ms.insert(sum.ms.end(), cell.ms.begin(), cell.ms.end());
  }
  return sum;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}
double median(const std::vector<double>& values) { return quantile(values, 0.5); }

std::string times(const LidarCell& cell) {
  return fmt::format("median {:.1f} ms, 99 % below {:.1f} ms", median(cell.ms), quantile(cell.ms, 0.99));
}

}  // namespace

const char* to_string(LidarAid aid) {
  switch (aid) {
    case LidarAid::kPrior:
      return "prior";
    case LidarAid::kPriorAndPrints:
      return "+ prints";
    case LidarAid::kPrints:
      return "prints";
    case LidarAid::kPriorByGicp:
      return "gicp";
  }
  return "";
}

void LidarCell::add(const LidarTrial& trial) {
  ++poses;
  ms.push_back(trial.locate_ms);
  ambiguous += trial.location.outcome == scan::LocateOutcome::kAmbiguous ? 1 : 0;
  refused += trial.location.outcome == scan::LocateOutcome::kRefused ? 1 : 0;
  wrong += trial.wrong() ? 1 : 0;
  if (!trial.bound.observable()) {
    ++unobservable;
    if (!trial.located() || !trial.location.weak.empty()) return;
    if (trial.location.print_points == 0) {
      ++missed;
      return;
    }
    ++closed;
    closed_squares_m2 += trial.position_error_m * trial.position_error_m;
    closed_nees += trial.nees;
    return;
  }
  ++observable;
  const bool is_found = trial.located() && trial.position_error_m < 0.03 && trial.rotation_error_rad < deg_to_rad(0.5);
  if (!is_found) return;
  ++found;
  nees += trial.nees;
  const double position = std::pow(trial.position_error_m / trial.bound.position_m, 2);
  if (is_cautious(trial)) {
    ++cautious;
    cautious_squares += position;
    return;
  }
  position_squares += position;
  rotation_squares += std::pow(trial.rotation_error_rad / trial.bound.rotation_rad, 2);
  bound_m.push_back(trial.bound.position_m);
  bound_rad.push_back(trial.bound.rotation_rad);
  error_m.push_back(trial.position_error_m);
  error_rad.push_back(trial.rotation_error_rad);
}

double LidarCell::position_ratio() const { return std::sqrt(position_squares / std::max(1, judged())); }
double LidarCell::rotation_ratio() const { return std::sqrt(rotation_squares / std::max(1, judged())); }
double LidarCell::mean_nees() const { return nees / std::max(1, found); }

std::vector<LidarCell> run_lidar_cells(const std::vector<LidarAid>& aids, int poses, const LidarSeeds& seeds) {
  const LidarRoom room(seeds.room);
  std::vector<LidarTrialSpec> specs;
  std::vector<LidarCell> cells;
  for (const LidarAid aid : aids) {
    for (const Tilt tilt : {Tilt::kUpright, Tilt::kTilted, Tilt::kSteep}) {
      LidarCell& cell = cells.emplace_back();
      cell.tilt = tilt;
      cell.aid = aid;
      for (int i = 0; i < poses; ++i) {
        LidarTrialSpec& spec = specs.emplace_back();
        spec.tilt = tilt;
        spec.prior = aid != LidarAid::kPrints;
        spec.use_reflectivity = aid == LidarAid::kPriorAndPrints || aid == LidarAid::kPrints;
        spec.method = aid == LidarAid::kPriorByGicp ? LidarMethod::kGicp : LidarMethod::kRayCast;
        spec.seed = seeds.pose + static_cast<uint64_t>(i);
      }
    }
  }
  std::vector<LidarTrial> trials(specs.size());
  std::atomic<std::size_t> next{0};
  std::vector<std::jthread> threads;
  for (unsigned t = 0; t < std::max(1U, std::thread::hardware_concurrency()); ++t) {
    threads.emplace_back([&] {
      for (std::size_t i = next++; i < specs.size(); i = next++) trials[i] = run_lidar_trial(room, specs[i]);
    });
  }
  threads.clear();
  for (std::size_t i = 0; i < trials.size(); ++i) cells[i / static_cast<std::size_t>(poses)].add(trials[i]);
  return cells;
}

std::vector<Bar> judge_lidar(const std::vector<LidarCell>& cells) {
  const LidarCell with = pooled(cells, LidarAid::kPrior), prints = pooled(cells, LidarAid::kPriorAndPrints);
  const LidarCell without = pooled(cells, LidarAid::kPrints);
  const int wrong = with.wrong + prints.wrong + without.wrong;
  const int missed = with.missed + prints.missed + without.missed;
  const double success = 100.0 * with.found / std::max(1, with.observable);
  const double tolerance = 6 * 4 * std::sqrt(2.0 / (6.0 * std::max(1, with.found)));
  const double slowest_ms = std::max({median(with.ms), median(prints.ms), median(without.ms)});
  return {
      {"observable poses located >= 99.5 %", fmt::format("{:.2f} % ({} of {})", success, with.found, with.observable),
       success >= 99.5},
      {"rms error <= 1.2 x bound, beam offsets estimated",
       fmt::format("position {:.2f}, rotation {:.2f} ({} poses; {} more name an axis open that the bound calls seen)",
                   with.position_ratio(), with.rotation_ratio(), with.judged(), with.cautious),
       with.position_ratio() <= 1.2 && with.rotation_ratio() <= 1.2},
      {"every unobservable pose flagged, unless prints fix it",
       fmt::format("{} missed of {}", missed, with.unobservable + prints.unobservable + without.unobservable),
       missed == 0},
      {"never wrong in what is called observed",
       fmt::format("{} wrong of {} with prior, {} of {} with prints, {} of {} without prior ({} ambiguous, {} refused)",
                   with.wrong, with.poses, prints.wrong, prints.poses, without.wrong, without.poses, without.ambiguous,
                   without.refused),
       wrong == 0},
      {"axes that prints close are right: rms <= 3 mm",
       fmt::format("{} of {} unobservable poses closed, position rms {:.2f} mm, NEES {:.1f}", prints.closed,
                   prints.unobservable, 1e3 * std::sqrt(prints.closed_squares_m2 / std::max(1, prints.closed)),
                   prints.closed_nees / std::max(1, prints.closed)),
       prints.closed_squares_m2 <= 9e-6 * prints.closed},
      {"mean NEES 6 within four sigmas", fmt::format("{:.2f} +- {:.2f}", with.mean_nees(), tolerance),
       std::abs(with.mean_nees() - 6) <= tolerance},
      {"one sweep of 28,800 points in <= 15 ms on one core",
       fmt::format("{} with prior; {} with prints; {} without prior", times(with), times(prints), times(without)),
       slowest_ms <= 15},
      {"<= 1 MiB beyond the sweep",
       fmt::format("{} KiB", (scan::locate_scratch_bytes() + sizeof(scan::Location)) / 1024),
       scan::locate_scratch_bytes() + sizeof(scan::Location) <= (1U << 20)}};
}

std::vector<Bar> judge_gicp(const std::vector<LidarCell>& cells) {
  const LidarCell direct = pooled(cells, LidarAid::kPrior), gicp = pooled(cells, LidarAid::kPriorByGicp);
  const double position = gicp.position_ratio(), rotation = gicp.rotation_ratio();
  return {{"GICP: every unobservable pose flagged", fmt::format("{} missed of {}", gicp.missed, gicp.unobservable),
           gicp.missed == 0},
          {"locate() is the more exact and the quicker one",
           fmt::format("GICP: {} of {} observable poses found, {} by ray casting; {:.1f} x the position error, {:.1f} "
                       "x the rotation error, {:.1f} x the time ({:.0f} ms)",
                       gicp.found, gicp.observable, direct.found, position / direct.position_ratio(),
                       rotation / direct.rotation_ratio(), median(gicp.ms) / median(direct.ms), median(gicp.ms)),
           position > direct.position_ratio() && median(gicp.ms) > median(direct.ms)}};
}

}  // namespace roomcal::tools
