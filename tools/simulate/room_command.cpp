#include "tools/simulate/room_command.h"

#include <cstdio>
#include <memory>
#include <string>

#include <fmt/core.h>

#include "tools/common/error.h"
#include "tools/simulate/make_room.h"
#include "tools/simulate/room_files.h"

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

}  // namespace

void add_room_command(CLI::App& simulate) {
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

}  // namespace roomcal::tools
