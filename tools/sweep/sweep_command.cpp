#include "tools/sweep/sweep_command.h"

#include <cmath>
#include <memory>
#include <string>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/sweep/cloud_files.h"
#include "tools/sweep/compare.h"
#include "tools/sweep/load_sweeps.h"
#include "tools/sweep/sweep_report.h"
#include "tools/sweep/wall_offsets.h"

namespace roomcal::tools {

namespace {

struct Options {
  LoadRequest request;
  std::string file, calibration, json_file, pcd_file, reference;
  double cut_deg = -1;
  std::size_t max_sweeps = 0;
  bool walls = false;
};

void run(Options options) {
  options.request.file = options.file;
  options.request.calibration = options.calibration;
  if (options.cut_deg >= 0) options.request.options.cut_cdeg = static_cast<int>(std::lround(100 * options.cut_deg));
  if (options.max_sweeps > 0) options.request.max_sweeps = options.max_sweeps;
  const Recording recording = load_sweeps(options.request);
  print_sweeps(options.file, options.request, recording);
  nlohmann::json report = sweep_json(options.file, options.request, recording);
  if (!options.reference.empty()) {
    const Comparison comparison = compare(recording, options.request, options.reference);
    print_comparison(comparison, options.reference);
    report["reference"] = to_json(comparison);
  }
  if (options.walls) {
    const WallOffsets walls = wall_offsets(recording);
    print_wall_offsets(walls);
    report["walls"] = to_json(walls);
  }
  if (!options.pcd_file.empty()) write_atomic(options.pcd_file, write_pcd(recording.sweeps));
  if (!options.json_file.empty()) write_atomic(options.json_file, report.dump(1) + "\n");
}

}  // namespace

void add_sweep_command(CLI::App& app, int& exit_code) {
  static_cast<void>(exit_code);  // no verdict: it tells what is there
  auto options = std::make_shared<Options>();
  CLI::App* sweep = app.add_subcommand("sweep", "decode a LiDAR recording (pcap, pcd, ply) and say what is in it");
  sweep->add_option("file", options->file, "recording")->required();
  sweep->add_option("--sensor", options->request.model,
                    "vlp16, vlp32c, hdl32e, xt16, xt32, xt32m, qt64, qt128, "
                    "pandar40p, pandar64, ouster, helios16p, mid360, r2000");
  sweep->add_option("--calibration", options->calibration, "the unit's angle file (CSV, YAML) or metadata JSON");
  sweep->add_flag("--dual", options->request.dual_returns,
                  "RoboSense without DIFOP packets: the unit is in dual return");
  sweep->add_option("--cut", options->cut_deg, "azimuth where turns are cut, degrees; default: where the file begins")
      ->check(CLI::Range(0.0, 359.99));
  sweep->add_option("--sweeps", options->max_sweeps, "stop after as many");
  sweep->add_option("--json", options->json_file, "write the report");
  sweep->add_option("--pcd", options->pcd_file, "write the points of all sweeps");
  sweep->add_option("--reference", options->reference,
                    "compare with a point cloud (nearest points) or with an Ouster digest JSON (MD5 of fields)");
  sweep->add_flag("--walls", options->walls, "per-beam range offsets against the flat walls that the sweeps see");
  sweep->callback([options] { run(*options); });
}

}  // namespace roomcal::tools
