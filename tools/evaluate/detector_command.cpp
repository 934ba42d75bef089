#include "tools/evaluate/detector_command.h"

#include <algorithm>
#include <memory>
#include <string>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tools/common/files.h"
#include "tools/evaluate/detector_sweep.h"

namespace roomcal::tools {

using nlohmann::json;

namespace {

struct Arguments {
  std::string json_file;
  bool quick = false;
};

double ms_per_marker(const CellResult& cell, double empty_ms_per_mp) {
  return (cell.detect_ms - empty_ms_per_mp * cell.megapixels) / std::max(1, cell.truths);
}

void print_table(const DetectorSweep& sweep) {
  fmt::print(
      "D px = outer diameter, grad = change of light over it (along +x), noise in grey levels, RMS of both axes\n");
  fmt::print(
      "together, CRB: 7-dof homography, light and its gradient, ink unknown; full: also radii and blur unknown\n\n");
  fmt::print("{:>5} {:>5} {:>4} {:>5} {:>8} {:>6} {:>7} {:>5} {:>17} {:>8} {:>8} {:>6} {:>6} {:>7} {:>9}\n", "D px",
             "slant", "grad", "noise", "lens", "n", "recall%", "false", "mean dx, dy px", "RMS px", "CRB px", "/CRB",
             "/full", "NEES/2", "ms/marker");
  for (const CellResult& cell : sweep.cells) {
    const CellSpec& spec = cell.spec;
    fmt::print(
        "{:5.0f} {:5.0f} {:4.1f} {:5.0f} {:>8} {:6} {:7.2f} {:5} {:+8.4f} {:+8.4f} {:8.4f} {:8.4f} {:6.2f} {:6.2f} "
        "{:7.2f} {:9.3f}\n",
        spec.diameter_px, spec.slant_deg, spec.gradient, spec.noise_sigma, spec.fisheye ? "fisheye" : "pinhole",
        cell.truths, 100 * cell.recall(), cell.false_alarms, cell.mean_error_px().x(), cell.mean_error_px().y(),
        cell.rms_px(), cell.bound_rms_px(), cell.ratio(), cell.rms_px() / std::sqrt(cell.bound_full_px2),
        cell.nees_half(), ms_per_marker(cell, sweep.empty_ms_per_mp));
  }
  const int over_capacity = pool(sweep.cells).over_capacity;
  if (over_capacity > 0) fmt::print("\n{} images held more shapes than the detector's tables\n", over_capacity);
  fmt::print("\nempty image: {:.2f} ms per megapixel\n", sweep.empty_ms_per_mp);
}

json to_json(const CellResult& cell, double empty_ms_per_mp) {
  return {{"diameter_px", cell.spec.diameter_px},
          {"slant_deg", cell.spec.slant_deg},
          {"gradient", cell.spec.gradient},
          {"noise", cell.spec.noise_sigma},
          {"lens", cell.spec.fisheye ? "fisheye" : "pinhole"},
          {"markers", cell.truths},
          {"found", cell.found},
          {"recall", cell.recall()},
          {"false_alarms", cell.false_alarms},
          {"images_over_capacity", cell.over_capacity},
          {"mean_px", {cell.mean_error_px().x(), cell.mean_error_px().y()}},
          {"mean_sigma_px", cell.mean_error_sigma_px()},
          {"rms_px", cell.rms_px()},
          {"bound_px", cell.bound_rms_px()},
          {"bound_full_px", std::sqrt(cell.bound_full_px2)},
          {"ratio", cell.ratio()},
          {"nees_half", cell.nees_half()},
          {"ms_per_marker", ms_per_marker(cell, empty_ms_per_mp)}};
}

json to_json(const DetectorSweep& sweep, const std::vector<Bar>& bars) {
  json node = {{"empty_ms_per_megapixel", sweep.empty_ms_per_mp}, {"cells", json::array()}, {"bars", json::array()}};
  for (const CellResult& cell : sweep.cells) node["cells"].push_back(to_json(cell, sweep.empty_ms_per_mp));
  for (const Bar& bar : bars) {
    node["bars"].push_back({{"demand", bar.demand}, {"measured", bar.measured}, {"met", bar.met}});
  }
  return node;
}

void evaluate_detector(const Arguments& arguments, int& exit_code) {
  const DetectorSweep sweep = run_detector_sweep(arguments.quick);
  const std::vector<Bar> bars = judge_sweep(sweep);
  print_table(sweep);
  for (const Bar& bar : bars) fmt::print("{} {}: {}\n", bar.met ? "met   " : "NOT MET", bar.demand, bar.measured);
  if (!arguments.json_file.empty()) write_atomic(arguments.json_file, to_json(sweep, bars).dump(1) + "\n");
  const bool all_met = std::all_of(bars.begin(), bars.end(), [](const Bar& bar) { return bar.met; });
  if (!all_met) exit_code = 2;
}

}  // namespace

void add_evaluate_detector(CLI::App& evaluate, int& exit_code) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* detector =
      evaluate.add_subcommand("detector", "ring detector against its Cramer-Rao bound, on simulated markers");
  detector->add_option("--json", arguments->json_file, "write the figures to this file");
  detector->add_flag("--quick", arguments->quick, "fewer sizes, slants and noises");
  detector->callback([arguments, &exit_code] { evaluate_detector(*arguments, exit_code); });
}

}  // namespace roomcal::tools
