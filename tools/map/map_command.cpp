#include "tools/map/map_command.h"

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "runtime/map/format.h"
#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/common/json_file.h"
#include "tools/common/option_check.h"
#include "tools/map/compare_command.h"
#include "tools/map/complete_map.h"
#include "tools/map/map_builder.h"
#include "tools/map/map_import.h"
#include "tools/map/map_info.h"
#include "tools/map/map_report.h"
#include "tools/map/noise.h"

namespace roomcal::tools {

namespace fs = std::filesystem;

namespace {

constexpr double kMaxSigma_m = 1;

struct ImportArguments {
  fs::path file, out;
  std::string id;
  double radius_m = 0;
  double sigma_m = 0;
};

struct InfoArguments {
  fs::path map, json, report, bake_json;
};

struct NoiseArguments {
  fs::path map, out;
  double sigma_m = 0;
  uint64_t seed = 1;
  bool declare = true;
};

// https://reproducible-builds.org/specs/source-date-epoch/: the file's bytes then repeat too, not only its content.
int64_t creation_time_unix_s() {
  const char* fixed = std::getenv("SOURCE_DATE_EPOCH");
  return fixed != nullptr ? std::strtoll(fixed, nullptr, 10) : static_cast<int64_t>(std::time(nullptr));
}

void print_written(const fs::path& out, const MapData& data, std::size_t bytes) {
  fmt::print("{}: {} markers on {} planes, {} triangles, {} bytes\n", out.string(), data.markers.size(),
             data.planes.size(), data.triangles.size(), bytes);
}

void write_map(const fs::path& out, const MapData& data) {
  const AlignedBytes bytes = build_map(data);
  write_atomic(out, bytes.span());
  print_written(out, data, bytes.span().size());
}

void run_import(const ImportArguments& arguments) {
  MapData data = parse_map_text(arguments.file.string(), read_text(arguments.file));
  data.id = arguments.id.empty() ? arguments.out.stem().string() : arguments.id;
  data.provenance = "imported from " + arguments.file.filename().string();
  data.created_unix_s = creation_time_unix_s();
  for (map::MapMarker& marker : data.markers) {
    marker.cov_m2 = arguments.sigma_m * arguments.sigma_m * Mat33::Identity();
    if (marker.has_radius || arguments.radius_m == 0) continue;
    marker.radius_m = arguments.radius_m;
    marker.has_radius = true;
  }
  complete_map(data);
  write_map(arguments.out, data);
}

void run_info(const InfoArguments& arguments) {
  const LoadedMap loaded = load_map(arguments.map);
  const MapQuality quality = measure_map_quality(to_map_data(loaded.map));
  const auto description = describe_map(loaded.map, loaded.bytes.span().size(), quality);
  fmt::print("{}", summarize_map(description, quality));
  if (!arguments.json.empty()) write_atomic(arguments.json, description.dump(1) + "\n");
  if (arguments.report.empty()) return;
  const auto bake = arguments.bake_json.empty() ? nlohmann::ordered_json() : read_json(arguments.bake_json);
  write_atomic(arguments.report, map_report(loaded.map, description, quality, bake));
  fmt::print("{}: open it in a browser\n", arguments.report.string());
}

void run_noise(const NoiseArguments& arguments) {
  MapData data = to_map_data(load_map(arguments.map).map);
  add_noise(data, arguments.sigma_m, arguments.seed, arguments.declare);
  data.created_unix_s = creation_time_unix_s();
  write_map(arguments.out, data);
}

void add_import(CLI::App& map) {
  auto arguments = std::make_shared<ImportArguments>();
  CLI::App* command = map.add_subcommand("import",
                                         "Make a map of a CSV (id,x,y,z[,nx,ny,nz][,radius], metres) or of "
                                         "the paper's map YAML");
  command->add_option("file", arguments->file, "CSV or YAML")->required();
  command->add_option("-o,--out", arguments->out, "The map to write, *.room")->required();
  command->add_option("--radius", arguments->radius_m, "Outer radius of markers that have none in the file, m")
      ->check(number_between(1e-4, map::kMaxRadius_m, "m"));
  command->add_option("--sigma", arguments->sigma_m, "Standard deviation of the positions per axis, m; 0: exact")
      ->check(number_between(0.0, kMaxSigma_m, "m"));
  command->add_option("--id", arguments->id, "Name of the map; default: the output's name");
  command->callback([arguments] { run_import(*arguments); });
}

void add_info(CLI::App& map) {
  auto arguments = std::make_shared<InfoArguments>();
  CLI::App* command = map.add_subcommand("info", "Say what is inside a map and how unique its marker pattern is");
  command->add_option("map", arguments->map, "*.room")->required();
  command->add_option("--json", arguments->json, "Write the same as JSON");
  auto* report = command->add_option("--report", arguments->report, "Write a page (HTML) that shows the map in 3-D");
  command->add_option("--bake-json", arguments->bake_json, "What `bake --json` wrote: adds the survey to the page")
      ->needs(report);
  command->callback([arguments] { run_info(*arguments); });
}

void add_noise_command(CLI::App& map) {
  auto arguments = std::make_shared<NoiseArguments>();
  CLI::App* command = map.add_subcommand("noise", "Move every marker by seeded Gaussian noise, for experiments");
  command->add_option("map", arguments->map, "*.room")->required();
  command->add_option("-o,--out", arguments->out, "The map to write, *.room")->required();
  command->add_option("--sigma", arguments->sigma_m, "Standard deviation per axis, m")
      ->required()
      ->check(number_between(0.0, kMaxSigma_m, "m"));
  command->add_option("--seed", arguments->seed, "Other seed, other noise; default 1");
  command->add_flag("--declare,!--no-declare", arguments->declare,
                    "Add sigma^2 to the map's covariances (default), so that the solver weighs it; or hide it");
  command->callback([arguments] { run_noise(*arguments); });
}

}  // namespace

void add_map_command(CLI::App& app, int& exit_code) {
  CLI::App* map = app.add_subcommand("map", "Import, inspect, compare and perturb room maps");
  map->require_subcommand(1);
  add_import(*map);
  add_info(*map);
  add_map_compare(*map, exit_code);
  add_noise_command(*map);
}

}  // namespace roomcal::tools
