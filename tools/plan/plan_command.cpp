#include "tools/plan/plan_command.h"

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/plan/plan_drawing.h"
#include "tools/plan/plan_report.h"
#include "tools/sheets/sheet_page.h"

namespace roomcal::tools {

namespace {

struct Arguments {
  std::string room;
  std::filesystem::path walls, csv, drawing, json;
  bool ceiling = false;
  int sheets = 0;
  std::string paper = "a4";
  double radius_mm = 0;
  double fov_deg = 77;
  double map_sigma_mm = 1;
  double target_percent = 85;
  uint64_t seed = 1;
};

void check_range(const char* option, double value, double low, double high) {
  if (value >= low && value <= high) return;  // NaN is not
  throw ToolError(fmt::format("{} {}: {} to {}", option, value, low, high));
}

SheetOutline outline_of(const SheetPage& page) {
  SheetOutline outline;
  outline.radius_m = 1e-3 * page.radius_mm;
  outline.below_left_m = 1e-3 * Vec2(-page.centre_mm.x(), page.centre_mm.y() - page.paper.size_mm.y());
  outline.above_right_m = 1e-3 * Vec2(page.paper.size_mm.x() - page.centre_mm.x(), page.centre_mm.y());
  return outline;
}

PlanOptions options_of(const Arguments& arguments) {
  check_range("--sheets", arguments.sheets, 0, 4096);
  check_range("--fov", arguments.fov_deg, 20, 140);
  check_range("--map-sigma", arguments.map_sigma_mm, 0, 100);
  check_range("--target", arguments.target_percent, 0, 100);
  PlanOptions options;
  options.outline = outline_of(layout_sheet(paper_named(arguments.paper), arguments.radius_mm, kBestRings));
  options.sheets = static_cast<std::size_t>(arguments.sheets);
  options.target_share = arguments.target_percent / 100;
  options.map_sigma_m = 1e-3 * arguments.map_sigma_mm;
  options.seed = arguments.seed;
  options.coverage.focal_px = 0.5 * options.coverage.width_px / std::tan(0.5 * deg_to_rad(arguments.fov_deg));
  return options;
}

std::vector<Wall> walls_of(const Arguments& arguments) {
  if (arguments.room.empty() == arguments.walls.empty()) {
    throw ToolError("plan: give the room either by --room 3x4x2.7 or by --walls FILE");
  }
  if (!arguments.room.empty()) return box_walls(arguments.room, arguments.ceiling);
  return read_walls(arguments.walls.string(), read_text(arguments.walls));
}

void run_plan(const Arguments& arguments, int& exit_code) {
  const PlanOptions options = options_of(arguments);
  const Plan plan = make_plan(walls_of(arguments), options);
  write_atomic(arguments.csv, layout_csv(plan));
  if (!arguments.drawing.empty()) write_drawing(plan, options, arguments.drawing);
  if (!arguments.json.empty()) write_atomic(arguments.json, plan_json(plan).dump(1) + "\n");
  fmt::print("{}", plan_text(plan, options));
  if (!plan.met && options.sheets == 0) exit_code = 2;  // who asks for a number gets it
}

}  // namespace

void add_plan_command(CLI::App& app, int& exit_code) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("plan", "Propose where to put how many sheets, and how good that will be");
  command->add_option("--room", arguments->room, "A box: width x depth x height in m, as in 3x4x2.7");
  command->add_option("--walls", arguments->walls, "Any room: a YAML of walls, see tools/plan/wall.h");
  command->add_flag("--ceiling", arguments->ceiling, "With --room: sheets on the ceiling too");
  command->add_option("-o,--out", arguments->csv, "Layout to write, a CSV that `map import` reads")->required();
  command->add_option("--drawing", arguments->drawing, "PDF to write: every wall with its sheets and measures");
  command->add_option("--json", arguments->json, "Write the layout and what is expected of it");
  command->add_option("--sheets", arguments->sheets, "How many; default: as many as --target needs");
  command->add_option("--target", arguments->target_percent, "Looks that shall find their place, %")
      ->capture_default_str();
  command->add_option("--fov", arguments->fov_deg, "Horizontal field of the camera, deg")->capture_default_str();
  command->add_option("--map-sigma", arguments->map_sigma_mm, "Expected error of the baked markers per axis, mm")
      ->capture_default_str();
  command->add_option("--paper", arguments->paper, "a4, a3 or letter")->capture_default_str();
  command->add_option("--radius", arguments->radius_mm, "Outer radius, mm; default: as large as the paper allows");
  command->add_option("--seed", arguments->seed, "Other seed, other layout")->capture_default_str();
  command->callback([arguments, &exit_code] { run_plan(*arguments, exit_code); });
}

}  // namespace roomcal::tools
