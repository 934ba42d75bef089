#include "tools/calibrate/calibrate_command.h"

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "runtime/calib/memory_plan.h"
#include "runtime/calib/session.h"
#include "runtime/calib/to_record.h"
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
#include "tools/map/map_builder.h"

namespace roomcal::tools {

namespace {

struct Options {
  std::string map_file;
  std::string device_file;
  std::string shot_folder;
  std::string json_file;
  std::string draw_folder;
  std::string truth_file;
  std::string record_file;
};

template <typename T>
T must(Result<T> result, const std::string& thing) {
  require(result.status(), thing);
  return std::move(result).value();
}

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
  context.firmware_id = "roomcal host";
  context.measured_unix_s = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  const auto record = std::make_unique<store::Record>();
  require(calib::to_record(outcome, device, context, *record), file);
  record->generation = record->content_generation = 1;
  record->written_unix_s = record->measured_unix_s;
  write_record(file, *record);
}

void report(const Options& options, const calib::Device& device, const map::RoomMap& map, const Shot& shot,
            const calib::Outcome& outcome, std::size_t arena_peak_bytes) {
  for (const std::string& trouble : shot.troubles) fmt::print(stderr, "roomcal: {}\n", trouble);
  print_outcome(outcome, arena_peak_bytes);
  if (!options.truth_file.empty()) print_against_truth(outcome, options.truth_file);
  if (!options.json_file.empty())
    write_atomic(options.json_file, to_json(outcome, device, map, arena_peak_bytes).dump(1) + "\n");
  if (!options.record_file.empty()) write_as_device(outcome, device, map, options.record_file);
  if (!options.draw_folder.empty()) draw_outcome(outcome, device, map, shot, options.draw_folder);
}

calib::Verdict run(const Options& options) {
  const LoadedMap loaded = load_map(options.map_file);
  const map::RoomMap& map = loaded.map;
  const auto device =
      std::make_unique<calib::Device>(to_runtime(read_device(options.device_file), options.device_file));
  const Shot shot = read_shot(options.shot_folder, *device);

  // As on the device: everything is reserved from the plan, then nothing is allocated.
  const calib::MemoryPlan plan = calib::plan_memory(*device, map);
  std::vector<std::byte> block(plan.total_bytes());
  Arenas arenas = must(Arenas::carve(block, plan.permanent_bytes, plan.scratch_bytes), "memory plan");
  const map::TriangleIndex index = must(map::TriangleIndex::build(map, arenas.permanent), options.map_file);
  arenas.permanent.seal();

  std::vector<ImageView> images;
  for (const cv::Mat& image : shot.images) images.push_back(view(image));
  const auto outcome = std::make_unique<calib::Outcome>();
  const calib::Session session{*device, map, index, {}};
  require(calib::calibrate(session, calib::Shot{images, {}}, SteadyClock(), arenas, *outcome), options.shot_folder);
  report(options, *device, map, shot, *outcome, arenas.peak());
  return outcome->verdict;
}

}  // namespace

void add_calibrate_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("calibrate", "one shot of images in, judged extrinsics out");
  command->add_option("--map", options->map_file, "baked room (*.room)")->required();
  command->add_option("--device", options->device_file, "device.yaml")->required();
  command->add_option("--shot", options->shot_folder, "folder with one image per camera, named after it")->required();
  command->add_option("--json", options->json_file, "write the result to this file");
  command->add_option("--draw", options->draw_folder, "write annotated pictures into this folder");
  command->add_option("--record", options->record_file,
                      "write the record that a device would store, if the verdict lets it");
  command->add_option("--truth", options->truth_file, "truth.json of a simulated shot: print errors beside sigmas");
  command->callback([options, &exit_code] { exit_code = calib::may_write(run(*options)) ? 0 : 2; });
}

}  // namespace roomcal::tools
