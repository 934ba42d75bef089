#include "tools/evaluate/rings_command.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/common/progress.h"
#include "tools/common/ring_bank.h"
#include "tools/evaluate/detector_cell.h"

namespace roomcal::tools {

namespace {

struct Arguments {
  std::vector<std::size_t> ids;
  std::string json_file;
};

/// One set of ratios; `near` are the markers that any ratios show, where only the centre's error differs.
struct RingFigures {
  std::size_t id = 0;
  CellResult hard, near;
};

// Where ratios matter: rings of about two pixels, and rings that a slant thins to that.
struct Look {
  double diameter_px;
  double slant_deg;
};
constexpr Look kHard[] = {{13, 0}, {15, 0}, {15, 45}, {18, 60}, {22, 70}, {30, 75}, {40, 78}};
constexpr Look kNear[] = {{30, 30}, {50, 45}};
constexpr int kMarkersPerLook = 250;

template <std::size_t count>
CellResult measure(std::size_t id, const Look (&looks)[count], std::vector<std::byte>& scratch) {
  std::vector<CellResult> cells;
  for (const Look& look : looks) {
    CellSpec spec;
    spec.diameter_px = look.diameter_px;
    spec.slant_deg = look.slant_deg;
    spec.ring_radii = cctag3_radii(id);
    for (const CellResult& cell : run_cells(spec, {2, 5}, kMarkersPerLook, scratch)) cells.push_back(cell);
  }
  return pool(cells);
}

std::string ratios_text(std::size_t id) { return fmt::format("{}", fmt::join(kCctag3Percent[id], " ")); }

nlohmann::ordered_json to_json(const RingFigures& figures) {
  return {{"id", figures.id},
          {"percent", kCctag3Percent[figures.id]},
          {"recall_small_or_slanted", figures.hard.recall()},
          {"rms_px_small_or_slanted", figures.hard.rms_px()},
          {"recall_near", figures.near.recall()},
          {"rms_px_near", figures.near.rms_px()},
          {"false_alarms", figures.hard.false_alarms + figures.near.false_alarms}};
}

void evaluate_rings(Arguments arguments) {
  if (arguments.ids.empty()) {
    for (std::size_t id = 0; id < kCctag3Percent.size(); ++id) arguments.ids.push_back(id);
  }
  std::vector<RingFigures> all;
  std::vector<std::byte> scratch;
  Progress progress("ring ratios", arguments.ids.size());
  for (const std::size_t id : arguments.ids) {
    all.push_back({id, measure(id, kHard, scratch), measure(id, kNear, scratch)});
    progress.step();
  }
  std::stable_sort(all.begin(), all.end(), [](const RingFigures& a, const RingFigures& b) {
    return a.hard.recall() != b.hard.recall() ? a.hard.recall() > b.hard.recall() : a.near.rms_px() < b.near.rms_px();
  });
  nlohmann::ordered_json report = nlohmann::ordered_json::array();
  fmt::print("best first; small or slanted: 13 to 40 px, 0 to 78 deg; near: 30 and 50 px; noise 2 and 5 grey levels\n");
  fmt::print("{:>3} {:<16} {:>9} {:>8} {:>9} {:>8} {:>6}\n", "id", "radii %", "recall %", "RMS px", "near %", "RMS px",
             "false");
  for (const RingFigures& f : all) {
    fmt::print("{:3} {:<16} {:9.2f} {:8.4f} {:9.2f} {:8.4f} {:6}\n", f.id, ratios_text(f.id), 100 * f.hard.recall(),
               f.hard.rms_px(), 100 * f.near.recall(), f.near.rms_px(), f.hard.false_alarms + f.near.false_alarms);
    report.push_back(to_json(f));
  }
  if (!arguments.json_file.empty()) write_atomic(arguments.json_file, report.dump(1) + "\n");
}

}  // namespace

void add_evaluate_rings(CLI::App& evaluate) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* rings = evaluate.add_subcommand("rings", "which CCTag-3 ring ratios the detector sees best, simulated");
  rings->add_option("--ids", arguments->ids, "CCTag-3 identities 0..31; default: all")
      ->delimiter(',')
      ->check(CLI::Range(0, 31));
  rings->add_option("--json", arguments->json_file, "write the figures to this file");
  rings->callback([arguments] { evaluate_rings(*arguments); });
}

}  // namespace roomcal::tools
