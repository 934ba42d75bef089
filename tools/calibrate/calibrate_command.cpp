#include "tools/calibrate/calibrate_command.h"

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "runtime/calib/memory_plan.h"
#include "runtime/calib/session.h"
#include "runtime/calib/to_record.h"
#include "tools/calibrate/outcome_detail.h"
#include "tools/calibrate/outcome_json.h"
#include "tools/calibrate/report.h"
#include "tools/calibrate/runtime_device.h"
#include "tools/calibrate/shot_folder.h"
#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/common/image_io.h"
#include "tools/common/steady_clock.h"
#include "tools/device/device_yaml.h"
#include "tools/export/record_file.h"
#include "tools/export/result_json.h"
#include "tools/join/join_shots.h"
#include "tools/map/map_builder.h"

namespace roomcal::tools {

using nlohmann::json;

namespace {

constexpr const char* kFirmware = "roomcal host";

struct Options {
  std::string map_file;
  std::string device_file;
  std::vector<std::string> shot_folders;
  std::string json_file;
  std::string draw_folder;
  std::string truth_file;
  std::string record_file;
  std::string installed_file;
  std::size_t sweeps = 1;
  bool dry_run = false;
  bool refine_intrinsics = false;
  bool detail = false;
};

/// A finished run.
struct Finished {
  calib::Verdict verdict = calib::Verdict::kFailService;
  bool unmoved = false;  ///< compared with the installed record, and nothing has moved
};

template <typename T>
T must(Result<T> result, const std::string& thing) {
  require(result.status(), thing);
  return std::move(result).value();
}

int64_t now_unix_s() { return std::chrono::system_clock::to_time_t(std::chrono::system_clock::now()); }

// What a device with this outcome would write first into its store.
void write_as_device(const calib::Outcome& outcome, const calib::Device& device, const map::RoomMap& map,
                     const std::string& file) {
  if (!calib::may_write(outcome.verdict)) {
    fmt::print(stderr, "roomcal: {}: not written, the verdict is {}\n", file, calib::to_string(outcome.verdict));
    return;
  }
  calib::RecordContext context;
  context.map_id = map.map_id();
  context.map_hash = map.content_crc32c();
  context.firmware_id = kFirmware;
  context.measured_unix_s = now_unix_s();
  const auto record = std::make_unique<store::Record>();
  require(calib::to_record(outcome, device, context, *record), file);
  record->generation = record->content_generation = 1;
  record->written_unix_s = record->measured_unix_s;
  write_record(file, *record);
}

// A finished run and all that it was made of.
struct Run {
  const Options& options;
  const Device& description;
  const calib::Session& session;
  const ShotFolder& shot;
  const calib::Outcome& outcome;
  std::size_t arena_peak_bytes;
  json joined;  ///< null for a single shot
};

void write_result(const Run& run) {
  const ResultContext context{run.description.name, run.description.serial, kFirmware,
                              now_unix_s(),         run.shot.sweep_files,   run.arena_peak_bytes};
  json result = to_json(run.outcome, run.session.device, run.session.map, context);
  if (!run.joined.is_null()) result["joined"] = run.joined;
  if (run.options.detail) add_detail(run.session, run.outcome, result);
  write_atomic(run.options.json_file, result.dump(1) + "\n");
}

void report(const Run& run) {
  const Options& options = run.options;
  for (const std::string& trouble : run.shot.troubles) fmt::print(stderr, "roomcal: {}\n", trouble);
  print_outcome(run.outcome, run.arena_peak_bytes);
  if (!options.truth_file.empty()) print_against_truth(run.outcome, options.truth_file);
  if (!options.json_file.empty()) write_result(run);
  if (!options.record_file.empty() && !options.dry_run)
    write_as_device(run.outcome, run.session.device, run.session.map, options.record_file);
  if (!options.draw_folder.empty() && options.shot_folders.size() == 1)
    draw_outcome(run.outcome, run.session.map, run.shot, options.draw_folder);
}

store::Record read_installed(const std::string& file) {
  if (std::filesystem::path(file).extension() == ".json") return parse_result(file, read_text(file));
  return read_record(file);
}

// As on the device: everything is reserved from the plan, then nothing is allocated.
class ArmedDevice {
 public:
  ArmedDevice(const calib::Device& device, const map::RoomMap& map, const std::string& map_file)
      : plan_(calib::plan_memory(device, map)),
        block_(plan_.total_bytes()),
        arenas_(must(Arenas::carve(block_, plan_.permanent_bytes, plan_.scratch_bytes), "memory plan")),
        index_(must(map::TriangleIndex::build(map, arenas_.permanent), map_file)) {
    if (!device.lidars.empty())
      surface_ = must(scan::Surface::build(map, {}, arenas_.permanent, arenas_.scratch), map_file);
    arenas_.permanent.seal();
  }

  calib::Session session(const calib::Device& device, const map::RoomMap& map, const calib::Limits& limits) const {
    return {.device = device, .map = map, .index = index_, .limits = limits, .surface = &surface_};
  }
  Arenas& arenas() { return arenas_; }

 private:
  calib::MemoryPlan plan_;
  std::vector<std::byte> block_;
  Arenas arenas_;
  map::TriangleIndex index_;
  scan::Surface surface_;
};

void calibrate_one(const std::string& folder_name, const calib::Session& session, const ShotFolder& folder,
                   ArmedDevice& armed, calib::Outcome& outcome) {
  const ShotView shot(folder);
  require(calib::calibrate(session, shot.shot(), SteadyClock(), armed.arenas(), outcome), folder_name);
}

/// Of several shots, what the result names.
struct Joined {
  ShotFolder first;  ///< without images and sweeps
  json shots = json::array();
  double agree_p_value = 1;
};

/// Shot by shot, each with the whole step arena to itself, then all together.
const calib::Outcome& calibrate_joined(const Options& options, const Device& description, const calib::Session& session,
                                       ArmedDevice& armed, ShotJoiner& joiner, Joined& files) {
  if (options.detail) throw ToolError("--detail looks into one shot: give one --shot, or leave it out");
  const auto outcome = std::make_unique<calib::Outcome>();
  for (const std::string& name : options.shot_folders) {
    ShotFolder folder = read_shot(name, description, options.sweeps);
    const Arena::Scope scope(armed.arenas().step);
    calibrate_one(name, session, folder, armed, *outcome);
    joiner.add(name, *outcome);
    for (const std::string& trouble : folder.troubles) fmt::print(stderr, "roomcal: {}: {}\n", name, trouble);
    fmt::print("{}: {}\n", name, calib::to_string(outcome->verdict));
    for (const Reason& reason : outcome->reasons) fmt::print("  {}\n", reason.view());
    if (!options.draw_folder.empty())
      draw_outcome(*outcome, session.map, folder,
                   std::filesystem::path(options.draw_folder) / fmt::format("shot{}", joiner.shots() - 1));
    if (files.first.sweep_files.empty()) files.first.sweep_files = folder.sweep_files;
    files.shots.push_back({{"folder", name}, {"verdict", calib::to_string(outcome->verdict)}});
  }
  const calib::Outcome& joined = joiner.join();
  files.agree_p_value = joiner.p_value();
  fmt::print("{} shots joined, p {:.2g} that they agree:\n", joiner.shots(), joiner.p_value());
  return joined;
}

Finished run(const Options& options) {
  const LoadedMap loaded = load_map(options.map_file);
  const Device description = read_device(options.device_file);
  const auto device = std::make_unique<calib::Device>(to_runtime(description, options.device_file));
  device->refine_intrinsics = options.refine_intrinsics;
  std::unique_ptr<store::Record> installed;
  if (!options.installed_file.empty())
    installed = std::make_unique<store::Record>(read_installed(options.installed_file));

  ArmedDevice armed(*device, loaded.map, options.map_file);
  calib::Session session = armed.session(*device, loaded.map, description.limits);
  session.installed = installed.get();
  const auto finish = [&](const ShotFolder& files, const calib::Outcome& outcome, const json& joined) -> Finished {
    report({options, description, session, files, outcome, armed.arenas().peak(), joined});
    return {outcome.verdict, outcome.installed.done && !outcome.installed.moved};
  };
  if (options.shot_folders.size() > 1) {
    ShotJoiner joiner(session);
    Joined files;
    const calib::Outcome& joined = calibrate_joined(options, description, session, armed, joiner, files);
    return finish(files.first, joined, {{"shots", files.shots}, {"agree_p_value", files.agree_p_value}});
  }
  const ShotFolder folder = read_shot(options.shot_folders[0], description, options.sweeps);
  const auto outcome = std::make_unique<calib::Outcome>();
  calibrate_one(options.shot_folders[0], session, folder, armed, *outcome);
  return finish(folder, *outcome, nullptr);
}

void add_common_options(CLI::App& command, Options& options) {
  command.add_option("--map", options.map_file, "baked room (*.room)")->required();
  command.add_option("--device", options.device_file, "device.yaml")->required();
  command
      .add_option(
          "--shot", options.shot_folders,
          "folder with an image per camera and a sweep file per LiDAR; several, from several places, are joined")
      ->required();
  command.add_option("--sweeps", options.sweeps, "sweeps of each LiDAR that take part; 0: all that are there")
      ->capture_default_str();
  command.add_flag("--refine-intrinsics", options.refine_intrinsics,
                   "refine the cameras' intrinsics along, with `intrinsics_sigma` of device.yaml as prior");
  CLI::Option* json = command.add_option("--json", options.json_file, "write the result to this file");
  command.add_flag("--detail", options.detail, "with every ring, its residual and the joint covariance in the result")
      ->needs(json);
  command.add_option("--draw", options.draw_folder, "write annotated pictures into this folder");
}

}  // namespace

void add_calibrate_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("calibrate", "a shot of images and sweeps in (or several), judged extrinsics out");
  add_common_options(*command, *options);
  command->add_option("--record", options->record_file,
                      "write the record that a device would store, if the verdict lets it");
  command->add_option("--truth", options->truth_file, "truth.json of a simulated shot: print errors beside sigmas");
  command->add_option("--installed", options->installed_file, "record or result in force: say what has moved since");
  command->add_flag("--dry-run", options->dry_run, "run and judge everything, write no record");
  command->callback([options, &exit_code] { exit_code = calib::may_write(run(*options).verdict) ? 0 : 2; });
}

void add_verify_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  options->dry_run = true;
  CLI::App* command = app.add_subcommand("verify", "one shot against the installed record: has a sensor moved?");
  add_common_options(*command, *options);
  command->add_option("--installed", options->installed_file, "record (or result, *.json) in force")->required();
  command->callback([options, &exit_code] {
    const Finished finished = run(*options);
    exit_code = calib::may_write(finished.verdict) && finished.unmoved ? 0 : 2;
  });
}

}  // namespace roomcal::tools
