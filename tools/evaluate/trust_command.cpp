#include "tools/evaluate/trust_command.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tools/common/files.h"
#include "tools/common/progress.h"
#include "tools/evaluate/trust_join.h"
#include "tools/evaluate/trust_map_noise.h"
#include "tools/evaluate/trust_trial.h"

namespace roomcal::tools {

using nlohmann::json;

namespace {

constexpr int kRooms = 8;
constexpr double kNamedBar = 0.99, kFalseAlarmBar = 0.01;

struct Arguments {
  int shots = 1000;
  TrustDeviceOptions options;
  std::vector<double> map_noise_mm;
  std::size_t join = 0;
  std::string json_file;
};

MoveTally measure(const Arguments& arguments) {
  const int shots = arguments.shots;
  std::vector<TrustRoom> rooms;
  for (uint64_t seed = 1; seed <= kRooms; ++seed) rooms.emplace_back(seed);
  Progress progress("trust", static_cast<std::size_t>(shots));
  MoveTally moves;
  for (int i = 0; i < shots; ++i) {
    run_move_trial(rooms[static_cast<std::size_t>(i % kRooms)], static_cast<uint64_t>(i) + 1, arguments.options, moves);
    progress.step();
  }
  return moves;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

/// Quantile of the mean of n chi-square values with 6 degrees of freedom (Wilson, Hilferty 1931).
double nees_quantile(std::size_t n, double z) {
  const double k = 6.0 * static_cast<double>(std::max<std::size_t>(1, n));
  return k * std::pow(1 - 2 / (9 * k) + z * std::sqrt(2 / (9 * k)), 3) /
         static_cast<double>(std::max<std::size_t>(1, n));
}

/// Two-sided 95 % for all pairs together (Sidak).
double deviate(std::size_t pairs) { return pairs <= 1 ? 1.960 : pairs <= 6 ? 2.631 : 2.935; }

bool print_and_judge(const MoveTally& moves, json& out) {
  const int seen = moves.moved - moves.unseen;
  const double named = seen == 0 ? 0 : static_cast<double>(moves.named) / seen;
  const double false_alarms = moves.moved == 0 ? 1 : static_cast<double>(moves.false_alarms) / moves.moved;
  fmt::print(
      "verify, a sensor moved by 5 mm or 0.3 degree: {} of {} named, {:.2f} % (bar {:.0f} %); {} named another; {} "
      "moved where the report says it does not see; {} shots refused\n",
      moves.named, seen, 100 * named, 100 * kNamedBar, moves.misnamed, moves.unseen, moves.refused);
  fmt::print("verify, nothing moved: {} false alarms in {}, {:.2f} % (bar {:.0f} %)\n", moves.false_alarms, moves.moved,
             100 * false_alarms, 100 * kFalseAlarmBar);
  bool good = named >= kNamedBar && false_alarms <= kFalseAlarmBar;
  out["verify"] = {{"moved", seen},          {"named", moves.named},     {"misnamed", moves.misnamed},
                   {"unseen", moves.unseen}, {"refused", moves.refused}, {"false_alarms", moves.false_alarms},
                   {"unmoved", moves.moved}};
  for (const auto& [pair, values] : moves.nees) {
    const double z = deviate(moves.nees.size()), low = nees_quantile(values.size(), -z),
                 high = nees_quantile(values.size(), z), nees = mean(values);
    fmt::print("NEES {:<16} {:6.3f} in [{:.3f}, {:.3f}]{}\n", pair, nees, low, high,
               nees > low && nees < high ? "" : "  OUTSIDE");
    out["nees"][pair] = {{"mean", nees}, {"low", low}, {"high", high}};
    good = good && nees > low && nees < high;
  }
  return good;
}

/// @return whether NEES of every kind of pair stays in its band.
bool print_pairs(const PairTallies& pairs, int shots, json& out) {
  bool good = true;
  for (const PairKind kind : kPairKinds) {
    const PairTally& pair = pairs[static_cast<std::size_t>(kind)];
    // The band of as many values as there are shots: pairs of one shot share their sensors and their map.
    const double z = deviate(kPairKinds.size()), low = nees_quantile(static_cast<std::size_t>(shots), -z),
                 high = nees_quantile(static_cast<std::size_t>(shots), z), nees = mean(pair.nees);
    const bool inside = nees > low && nees < high;
    fmt::print("  {:<14} NEES {:6.3f} in [{:.3f}, {:.3f}]{}  RMS {:.3f} mm {:.4f} deg, said {:.3f} mm {:.4f} deg\n",
               to_string(kind), nees, low, high, inside ? "" : "  OUTSIDE", 1e3 * pair.rms_m(),
               rad_to_deg(pair.rms_rad()), 1e3 * pair.sigma_m(), rad_to_deg(pair.sigma_rad()));
    out[to_string(kind)] = {
        {"nees", nees}, {"low", low}, {"high", high}, {"rms_m", pair.rms_m()}, {"sigma_m", pair.sigma_m()}};
    good = good && inside;
  }
  return good;
}

/// What joining shots makes of pairs, and whether a sensor that moved between them is found out.
bool measure_join(const Arguments& arguments, json& out) {
  std::vector<TrustRoom> rooms;
  for (uint64_t seed = 1; seed <= kRooms; ++seed) rooms.emplace_back(seed);
  Progress progress("joined", static_cast<std::size_t>(arguments.shots));
  JoinTally tally;
  tally.shots_each = arguments.join;
  tally.map_sigma_m = arguments.map_noise_mm.empty() ? 0 : 1e-3 * arguments.map_noise_mm.front();
  for (int i = 0; i < arguments.shots; ++i) {
    run_join_trial(rooms[static_cast<std::size_t>(i % kRooms)], static_cast<uint64_t>(i) + 1, arguments.options, tally);
    progress.step();
  }
  fmt::print("one shot: {} of {} pass\n", tally.alone_passed, tally.trials);
  print_pairs(tally.alone, tally.trials, out["alone"]);
  fmt::print("{} shots joined: {} of {} pass\n", tally.shots_each, tally.joined_passed, tally.trials);
  const bool honest = print_pairs(tally.joined, tally.trials, out["joined"]);
  fmt::print("a sensor moved before the last shot: {} of {} refused, {} name it; false alarms where none moved: {}\n",
             tally.refused, tally.moved, tally.named, tally.false_alarms);
  out["moved"] = {{"trials", tally.moved},
                  {"refused", tally.refused},
                  {"named", tally.named},
                  {"false_alarms", tally.false_alarms}};
  return honest && tally.false_alarms <= kFalseAlarmBar * tally.trials;
}

/// What noise of the map makes of pairs, and whether they say so. @return whether NEES stays in its band.
bool measure_map_noise(const Arguments& arguments, json& out) {
  std::vector<TrustRoom> rooms;
  for (uint64_t seed = 1; seed <= kRooms; ++seed) rooms.emplace_back(seed);
  Progress progress("map noise", arguments.map_noise_mm.size() * static_cast<std::size_t>(arguments.shots));
  bool good = true;
  for (const double noise_mm : arguments.map_noise_mm) {
    MapNoiseTally tally;
    tally.sigma_m = 1e-3 * noise_mm;
    for (int i = 0; i < arguments.shots; ++i) {
      run_map_noise_trial(rooms[static_cast<std::size_t>(i % kRooms)], static_cast<uint64_t>(i) + 1, tally);
      progress.step();
    }
    fmt::print("map noise {} mm: {} of {} shots pass\n", noise_mm, tally.passed, tally.shots);
    json& node = out["map_noise"][fmt::format("{}", noise_mm)];
    good = print_pairs(tally.pairs, tally.shots, node) && good;
  }
  return good;
}

}  // namespace

void add_evaluate_trust(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("trust", "is the sensor that moved named, is NEES 6");
  command->add_option("--shots", arguments->shots, "shots with a moved sensor")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_flag("--refine-intrinsics", arguments->options.refine_intrinsics,
                    "lenses off by a draw from their prior, refined along");
  command->add_option("--map-noise", arguments->map_noise_mm, "only: pairs with maps of this noise, mm, that say so")
      ->check(CLI::Range(0.0, 50.0));
  command->add_option("--join", arguments->join, "only: as many shots of each device, joined")->check(CLI::Range(2, 8));
  command->add_option("--json", arguments->json_file, "write the figures to this file");
  command->callback([arguments, &exit_code] {
    json out;
    const bool good = arguments->join > 0               ? measure_join(*arguments, out)
                      : arguments->map_noise_mm.empty() ? print_and_judge(measure(*arguments), out)
                                                        : measure_map_noise(*arguments, out);
    if (!arguments->json_file.empty()) write_atomic(arguments->json_file, out.dump(1) + "\n");
    exit_code = good ? 0 : 2;
  });
}

}  // namespace roomcal::tools
