#include "tools/map/compare_command.h"

#include <filesystem>
#include <memory>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/common/option_check.h"
#include "tools/map/compare.h"
#include "tools/map/map_builder.h"
#include "tools/map/map_import.h"
#include "tools/map/plane_fit.h"

namespace roomcal::tools {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

namespace {

struct Arguments {
  fs::path a, b, json;
  double gate_mm = 50;
};

/// A `.room`, our CSV or the paper's YAML.
MapData read_any_map(const fs::path& path) {
  if (path.extension() == ".room") return to_map_data(load_map(path).map);
  MapData data = parse_map_text(path.string(), read_text(path));
  data.planes = fit_planes(data.markers);
  return data;
}

/// Ids of the markers that `matched` does not name. @param first  of the pairs' two numbers, or the second.
std::vector<uint32_t> unmatched(const MapData& data, const MapComparison& comparison, bool first) {
  std::vector<bool> named(data.markers.size());
  for (const auto& [i, j] : comparison.matched) named[first ? i : j] = true;
  std::vector<uint32_t> ids;
  for (std::size_t i = 0; i < named.size(); ++i) {
    if (!named[i]) ids.push_back(data.markers[i].id);
  }
  return ids;
}

ordered_json planes_json(const MapComparison& comparison) {
  ordered_json planes = ordered_json::array();
  for (const PlaneDifference& p : comparison.planes) {
    planes.push_back(
        {{"a", p.plane_a}, {"b", p.plane_b}, {"angle_deg", rad_to_deg(p.angle_rad)}, {"offset_mm", 1e3 * p.offset_m}});
  }
  return planes;
}

ordered_json to_json(const MapData& a, const MapData& b, const MapComparison& c) {
  ordered_json T = ordered_json::array();
  for (int row = 0; row < 4; ++row) {
    const Eigen::RowVector4d r = c.T_a_b.matrix().row(row);
    T.push_back({r[0], r[1], r[2], r[3]});
  }
  return {{"markers_a", a.markers.size()},
          {"markers_b", b.markers.size()},
          {"matched", c.matched.size()},
          {"mean_mm", 1e3 * c.mean_m},
          {"rms_mm", 1e3 * c.rms_m},
          {"max_mm", 1e3 * c.max_m},
          {"scale_a_b", c.scale_a_b},
          {"rms_after_scale_mm", 1e3 * c.rms_after_scale_m},
          {"only_in_a", unmatched(a, c, true)},
          {"only_in_b", unmatched(b, c, false)},
          {"T_a_b", T},
          {"planes", planes_json(c)}};
}

void print(const MapData& a, const MapData& b, const MapComparison& c) {
  fmt::print("{} of {} and {} markers matched\n", c.matched.size(), a.markers.size(), b.markers.size());
  fmt::print("distance after rigid alignment: mean {:.3f} mm, rms {:.3f} mm, max {:.3f} mm\n", 1e3 * c.mean_m,
             1e3 * c.rms_m, 1e3 * c.max_m);
  fmt::print("scale of A over B {:.6f}; rms if B were scaled {:.3f} mm\n", c.scale_a_b, 1e3 * c.rms_after_scale_m);
  for (const PlaneDifference& p : c.planes) {
    fmt::print("plane {} of A, {} of B: {:.3f} deg, {:+.2f} mm\n", p.plane_a, p.plane_b, rad_to_deg(p.angle_rad),
               1e3 * p.offset_m);
  }
}

void run(const Arguments& arguments, int& exit_code) {
  const MapData a = read_any_map(arguments.a), b = read_any_map(arguments.b);
  CompareOptions options;
  options.gate_m = 1e-3 * arguments.gate_mm;
  const auto comparison = compare_maps(a, b, options);
  if (!comparison) {
    fmt::print("the maps have no place in common: two rooms, or too much noise (see --gate)\n");
    if (!arguments.json.empty()) write_atomic(arguments.json, ordered_json{{"matched", 0}}.dump(1) + "\n");
    exit_code = 2;
    return;
  }
  print(a, b, *comparison);
  if (!arguments.json.empty()) write_atomic(arguments.json, to_json(a, b, *comparison).dump(1) + "\n");
}

}  // namespace

void add_map_compare(CLI::App& map, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = map.add_subcommand("compare",
                                         "Align two maps without identities and say how far they differ; each may be "
                                         "a .room, a CSV or the paper's YAML");
  command->add_option("A", arguments->a, "the map to measure by")->required();
  command->add_option("B", arguments->b, "the map to measure")->required();
  command->add_option("--json", arguments->json, "Write the figures to this file");
  command->add_option("--gate", arguments->gate_mm, "Markers farther apart than this are not the same, mm")
      ->check(number_between(0.1, 1000.0, "mm"))
      ->capture_default_str();
  command->callback([arguments, &exit_code] { run(*arguments, exit_code); });
}

}  // namespace roomcal::tools
