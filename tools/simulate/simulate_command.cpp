#include "tools/simulate/simulate_command.h"

#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "tools/common/error.h"
#include "tools/common/option_check.h"
#include "tools/common/progress.h"
#include "tools/simulate/make_room.h"
#include "tools/simulate/room_files.h"
#include "tools/simulate/shot_files.h"

namespace roomcal::tools {

namespace {

/// "3x4x2.7". @throws ToolError
Vec3 parse_size(const std::string& text) {
  Vec3 size;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lfx%lfx%lf%c", &size.x(), &size.y(), &size.z(), &rest) != 3 || !size.allFinite()) {
    throw ToolError("--size " + text + ": want width x depth x height in metres, as in 3x4x2.7");
  }
  return size;
}

struct RoomArguments {
  RoomOptions options;
  std::string size = "3x4x2.7";
  std::string folder;
};

void simulate_room(RoomArguments arguments) {
  arguments.options.size = parse_size(arguments.size);
  const Scene scene = make_room(arguments.options);
  write_room(scene, arguments.folder);
  fmt::print("{}: room {} m, {} markers, {} bodies, {} lamps, seed {}\n", arguments.folder, arguments.size,
             markers_of(scene).size(), scene.bodies.size(), scene.lamps.size(), scene.seed);
}

void add_room(CLI::App& simulate) {
  const auto arguments = std::make_shared<RoomArguments>();
  CLI::App* room = simulate.add_subcommand("room", "random room: markers.csv, planes.json, room.json");
  room->add_option("-o,--output", arguments->folder, "folder to write")->required();
  room->add_option("--seed", arguments->options.seed, "same seed, same room")->capture_default_str();
  room->add_option("--markers", arguments->options.markers, "A4 sheets")
      ->check(CLI::Range(0, 5000))
      ->capture_default_str();
  room->add_option("--size", arguments->size, "width x depth x height, m")->capture_default_str();
  room->add_option("--distractors", arguments->options.distractors, "discs, targets, fans, text")
      ->check(CLI::Range(0, 200))
      ->capture_default_str();
  room->add_option("--boxes", arguments->options.boxes, "things standing about, with shadows")
      ->check(CLI::Range(0, 20))
      ->capture_default_str();
  room->add_flag("--pillar", arguments->options.pillar, "with a pillar");
  room->callback([arguments] { simulate_room(*arguments); });
}

struct ShotArguments {
  ShotOptions options;
  PictureFormat format;
  std::string room;
  std::string device;
  std::string folder;
};

void simulate_shot(const ShotArguments& arguments) {
  const PaperDevice& device = device_named(arguments.device);
  const Scene scene = read_room(arguments.room);
  const Stand stand = place_device(scene, device, arguments.options);
  const LitScene lit(scene);
  std::vector<Picture> pictures;
  Progress progress("rendering " + device.name, stand.cameras.size());
  for (std::size_t i = 0; i < stand.cameras.size(); ++i) {
    const TrueCamera& camera = stand.cameras[i];
    pictures.push_back(take_picture(lit, camera, arguments.options, arguments.options.seed * 100 + i));
    write_picture(pictures.back(), camera.name, arguments.format, arguments.folder);
    pictures.back().image.release();  // a scanner's pictures take 16 MB each
    progress.step();
  }
  write_shot_facts(scene, stand, pictures, arguments.options, arguments.folder);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    fmt::print("{}/{}: {} markers\n", arguments.folder, stand.cameras[i].name, pictures[i].markers.size());
  }
}

void add_shot(CLI::App& simulate) {
  const auto arguments = std::make_shared<ShotArguments>();
  ShotOptions& options = arguments->options;
  CLI::App* shot = simulate.add_subcommand("shot", "pictures of a device in a room: images, camchain, nominal, truth");
  shot->add_option("--room", arguments->room, "folder of `simulate room`")->required();
  shot->add_option("--device", arguments->device, "stereo_rig, mobile_robot, backpack or tls")->required();
  shot->add_option("-o,--output", arguments->folder, "folder to write")->required();
  shot->add_option("--seed", options.seed, "same seed, same shot")->capture_default_str();
  shot->add_option("--blur", options.blur_px, "sigma of the point spread, px")
      ->check(number_between(0.0, 10.0, "px"))
      ->capture_default_str();
  shot->add_option("--motion", options.motion_px, "motion during the exposure, px")
      ->check(number_between(0.0, 50.0, "px"))
      ->capture_default_str();
  shot->add_option("--noise", options.noise_sigma, "sigma at mid grey, grey levels")
      ->check(number_between(0.0, 50.0))
      ->capture_default_str();
  shot->add_option("--exposure", options.exposure, "1: a tenth of the paper saturates")
      ->check(number_between(0.01, 20.0))
      ->capture_default_str();
  shot->add_option("--jpeg", arguments->format.jpeg_quality, "JPEG of this quality instead of PNG")
      ->check(CLI::Range(1, 100));
  shot->callback([arguments] { simulate_shot(*arguments); });
}

}  // namespace

void add_simulate_command(CLI::App& app, int& exit_code) {
  static_cast<void>(exit_code);  // makes things, judges nothing
  CLI::App* simulate = app.add_subcommand("simulate", "make a room and shots in it, with known truth");
  simulate->require_subcommand(1);
  add_room(*simulate);
  add_shot(*simulate);
}

}  // namespace roomcal::tools
