#include "tools/simulate/room_command.h"

#include <cstdio>
#include <memory>
#include <string>

#include <fmt/core.h>

#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/common/option_check.h"
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
  std::string walls;
  double waviness_mm = 0;
  std::string folder;
};

void simulate_room(RoomArguments arguments) {
  arguments.options.size = parse_size(arguments.size);
  arguments.options.waviness_m = 1e-3 * arguments.waviness_mm;
  if (!arguments.walls.empty()) arguments.options.walls = read_walls(arguments.walls, read_text(arguments.walls));
  const Scene scene = make_room(arguments.options);
  write_room(scene, arguments.folder);
  fmt::print("{}: room {} m, {} markers, {} bodies, {} lamps, seed {}\n", arguments.folder,
             arguments.walls.empty() ? arguments.size
                                     : fmt::format("of {} walls, {:.1f}x{:.1f}x{:.1f}", scene.walls.size(),
                                                   scene.size.x(), scene.size.y(), scene.size.z()),
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
  room->add_option("--furniture", arguments->options.furniture, "tables, cabinets, shelves, ducts before the sheets")
      ->check(CLI::Range(0, 40))
      ->capture_default_str();
  room->add_option("--walls", arguments->walls, "any room instead of --size: a YAML of walls as for `plan --walls`");
  room->add_option("--waviness", arguments->waviness_mm, "standard deviation of walls and floor from planes, mm")
      ->check(number_between(0.0, 20.0, "mm"))
      ->capture_default_str();
  room->add_flag("--pillar", arguments->options.pillar, "with a pillar");
  room->callback([arguments] { simulate_room(*arguments); });
}

}  // namespace roomcal::tools
