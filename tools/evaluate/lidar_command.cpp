#include "tools/evaluate/lidar_command.h"

#include <algorithm>
#include <memory>
#include <string>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tools/common/files.h"
#include "tools/evaluate/lidar_bars.h"

namespace roomcal::tools {

using nlohmann::json;

namespace {

constexpr const char* kDirect = "raycast";
constexpr const char* kGicp = "gicp";

struct Arguments {
  std::string json_file;
  std::string method = kDirect;
  int poses = 334;
  LidarSeeds seeds;
};

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void print_table(const std::vector<LidarCell>& cells) {
  fmt::print(
      "VLP-16 in a room of 3 x 4 x 2.7 m with a pillar, sigma 15 mm, beam offsets 10 mm; prior off by 0.2 m, 10 deg\n");
  fmt::print(
      "medians of found poses; /bnd: RMS of the error over each pose's own bound; closed: open axes fixed by "
      "prints\n\n");
  fmt::print(
      "{:>8} {:>9} {:>5} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>5} {:>5} {:>8} {:>8} {:>8} {:>8} {:>5} {:>5} {:>5} "
      "{:>6}\n",
      "aid", "tilt", "poses", "observ", "found", "unobs", "missed", "closed", "ambig", "refus", "wrong", "bound mm",
      "error mm", "bnd deg", "err deg", "/bnd", "/bnd", "NEES", "ms");
  for (const LidarCell& c : cells) {
    fmt::print(
        "{:>8} {:>9} {:5} {:6} {:6} {:6} {:6} {:6} {:6} {:5} {:5} {:8.2f} {:8.2f} {:8.4f} {:8.4f} {:5.2f} {:5.2f} "
        "{:5.2f} "
        "{:6.1f}\n",
        to_string(c.aid), to_string(c.tilt), c.poses, c.observable, c.found, c.unobservable, c.missed, c.closed,
        c.ambiguous, c.refused, c.wrong, 1e3 * median(c.bound_m), 1e3 * median(c.error_m),
        rad_to_deg(median(c.bound_rad)), rad_to_deg(median(c.error_rad)), c.position_ratio(), c.rotation_ratio(),
        c.mean_nees(), median(c.ms));
  }
  fmt::print("\n");
}

json to_json(const std::vector<LidarCell>& cells, const std::vector<Bar>& bars) {
  json node = {{"cells", json::array()}, {"bars", json::array()}};
  for (const LidarCell& c : cells) {
    node["cells"].push_back({{"aid", to_string(c.aid)},
                             {"tilt", to_string(c.tilt)},
                             {"poses", c.poses},
                             {"observable", c.observable},
                             {"found", c.found},
                             {"unobservable", c.unobservable},
                             {"missed", c.missed},
                             {"ambiguous", c.ambiguous},
                             {"refused", c.refused},
                             {"wrong", c.wrong},
                             {"cautious", c.cautious},
                             {"closed_by_prints", c.closed},
                             {"position_over_bound", c.position_ratio()},
                             {"rotation_over_bound", c.rotation_ratio()},
                             {"position_error_mm", 1e3 * median(c.error_m)},
                             {"rotation_error_deg", rad_to_deg(median(c.error_rad))},
                             {"nees", c.mean_nees()},
                             {"cpu_ms", median(c.ms)}});
  }
  for (const Bar& bar : bars) {
    node["bars"].push_back({{"demand", bar.demand}, {"measured", bar.measured}, {"met", bar.met}});
  }
  return node;
}

void evaluate_lidar(const Arguments& arguments, int& exit_code) {
  const bool gicp = arguments.method == kGicp;
  const std::vector<LidarAid> aids = gicp ? std::vector{LidarAid::kPrior, LidarAid::kPriorByGicp}
                                          : std::vector{LidarAid::kPrior, LidarAid::kPriorAndPrints, LidarAid::kPrints};
  const std::vector<LidarCell> cells = run_lidar_cells(aids, arguments.poses, arguments.seeds);
  const std::vector<Bar> bars = gicp ? judge_gicp(cells) : judge_lidar(cells);
  print_table(cells);
  for (const Bar& bar : bars) fmt::print("{} {}: {}\n", bar.met ? "met   " : "NOT MET", bar.demand, bar.measured);
  if (!arguments.json_file.empty()) write_atomic(arguments.json_file, to_json(cells, bars).dump(1) + "\n");
  if (!std::all_of(bars.begin(), bars.end(), [](const Bar& bar) { return bar.met; })) exit_code = 2;
}

}  // namespace

void add_evaluate_lidar(CLI::App& evaluate, int& exit_code) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* lidar = evaluate.add_subcommand("lidar", "location of simulated LiDAR sweeps against the Cramer-Rao bound");
  lidar->add_option("--poses", arguments->poses, "for each of three ways to hold it and each aid")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  lidar->add_option("--room-seed", arguments->seeds.room, "of the room")->capture_default_str();
  lidar->add_option("--seed", arguments->seeds.pose, "of the first pose; the others follow")->capture_default_str();
  lidar->add_option("--method", arguments->method, "gicp: Generalized ICP beside ray casting, on the same sweeps")
      ->check(CLI::IsMember({kDirect, kGicp}))
      ->capture_default_str();
  lidar->add_option("--json", arguments->json_file, "write the figures to this file");
  lidar->callback([arguments, &exit_code] { evaluate_lidar(*arguments, exit_code); });
}

}  // namespace roomcal::tools
