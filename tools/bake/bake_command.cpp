#include "tools/bake/bake_command.h"

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/core.h>

#include "runtime/map/format.h"
#include "tools/bake/bake_report.h"
#include "tools/bake/extend.h"
#include "tools/bake/survey_json.h"
#include "tools/bake/survey_reader.h"
#include "tools/common/files.h"
#include "tools/common/option_check.h"
#include "tools/map/map_builder.h"

namespace roomcal::tools {

namespace fs = std::filesystem;

namespace {

struct Arguments {
  fs::path survey, stereo, out, json, detections, extend;
  std::size_t pairs = 0;
  std::string id;
  BakeOptions bake;
};

int64_t creation_time_unix_s() {
  // https://reproducible-builds.org/specs/source-date-epoch/
  const char* fixed = std::getenv("SOURCE_DATE_EPOCH");
  return fixed != nullptr ? std::strtoll(fixed, nullptr, 10) : static_cast<int64_t>(std::time(nullptr));
}

Survey read(const Arguments& arguments, const StereoRig& rig) {
  Survey survey = read_survey(arguments.survey, rig);
  if (!arguments.detections.empty()) write_atomic(arguments.detections, to_survey_json(survey, rig));
  if (arguments.pairs > 0 && arguments.pairs < survey.views.size()) survey.views.resize(arguments.pairs);
  return survey;
}

void run(const Arguments& arguments) {
  const auto start = std::chrono::steady_clock::now();
  const StereoRig rig = read_stereo_rig(arguments.stereo);
  std::optional<MapData> old;
  if (!arguments.extend.empty()) old = to_map_data(load_map(arguments.extend).map);
  const Survey survey = read(arguments, rig);
  BakeResult result = bake(survey, rig, arguments.bake);
  nlohmann::ordered_json json = bake_json(survey, rig, result);
  std::string text = bake_text(survey, rig, result);
  result.data.id = arguments.out.stem().string();
  result.data.provenance = "baked from " + arguments.survey.filename().string();
  if (old) {
    MapChanges changes;
    MapData extended = extend_map(*old, result, {}, changes);
    extended.provenance = old->provenance + "; extended by a survey, " + arguments.survey.filename().string();
    result.data = std::move(extended);
    json["extended"] = changes_json(changes);
    text += changes_text(changes);
  }
  if (!arguments.id.empty()) result.data.id = arguments.id;
  result.data.created_unix_s = creation_time_unix_s();
  const AlignedBytes bytes = build_map(result.data);
  write_atomic(arguments.out, bytes.span());
  if (!arguments.json.empty()) write_atomic(arguments.json, json.dump(1) + "\n");
  const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double processor_s = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  fmt::print("{}{}: {} markers, {} bytes, {} pairs in {:.1f} s ({:.1f} s of processor)\n", text, arguments.out.string(),
             result.data.markers.size(), bytes.span().size(), survey.views.size(), elapsed_s, processor_s);
}

}  // namespace

void add_bake_command(CLI::App& app, int& exit_code) {
  static_cast<void>(exit_code);
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("bake", "Make a room map of a hand-held stereo survey");
  command
      ->add_option("survey", arguments->survey,
                   "Folder with cam0/ and cam1/ (or left/ and right/), saved detections (*.json), or the paper's map "
                   "YAML (its key points)")
      ->required();
  command
      ->add_option("--stereo", arguments->stereo,
                   "Calibration of the pair: Kalibr camchain or device.yaml, left camera first")
      ->required();
  command->add_option("-o,--out", arguments->out, "The map to write, *.room")->required();
  command->add_option("--json", arguments->json, "Write all figures to this file");
  command->add_option("--save-detections", arguments->detections,
                      "Write what was found in the images, to bake again without searching (*.json)");
  RefineRig& refine = arguments->bake.reconstruct.refine_rig;
  CLI::Option* always = command->add_flag_callback(
      "--refine-stereo", [&refine] { refine = RefineRig::kAlways; },
      "Refine the pair's intrinsics and extrinsics along, held by a prior about the calibration; default: where the "
      "images contradict it");
  command
      ->add_flag_callback(
          "--hold-stereo", [&refine] { refine = RefineRig::kNever; }, "Believe the calibration as it is")
      ->excludes(always);
  RigPrior& prior = arguments->bake.reconstruct.prior;
  command
      ->add_option("--focal-sigma", prior.focal,
                   "Where the calibration is refined: how far focal lengths may be off, relative")
      ->check(number_between(1e-9, 0.1))
      ->capture_default_str();
  command
      ->add_option("--baseline-sigma", prior.baseline,
                   "Where the calibration is refined: how far the baseline may be off, relative")
      ->check(number_between(1e-9, 0.1))
      ->capture_default_str();
  command->add_option("--distances", arguments->bake.distances,
                      "Measured distances, CSV a,b,distance_m[,sigma_m]; an end is a marker's id or <pair>@<x>:<y> in "
                      "the left image. They decide the scale");
  command
      ->add_option("--marker-radius", arguments->bake.marker_radius_m,
                   "Outer radius of the printed markers, measured, m. It decides the scale")
      ->check(number_between(1e-3, map::kMaxRadius_m, "m"));
  command->add_option("--extend", arguments->extend,
                      "Put the survey into this map (*.room), made before the room changed: says which markers moved, "
                      "vanished or are new; the old map keeps frame, scale and ids");
  command->add_option("--pairs", arguments->pairs, "Use only so many pairs from the start; default: all");
  command->add_option("--id", arguments->id, "Name of the map; default: the output's name");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace roomcal::tools
