#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/core.h>

#include "tools/common/files.h"
#include "tools/common/option_check.h"
#include "tools/evaluate/anchor_room.h"
#include "tools/map/map_builder.h"

namespace roomcal::tools {
namespace {

struct Arguments {
  std::filesystem::path file;
  std::filesystem::path json, map;
  double map_sigma_mm = 1e3 * AnchorRoomOptions{}.map_sigma_m;
  AnchorRoomOptions options;
};

void print_camera(const char* side, const camera::Intrinsics& k, double median_px) {
  fmt::print("  {:<6} fx {:8.2f}  fy {:8.2f}  cx {:8.2f}  cy {:8.2f}  median residual {:.2f} px\n", side, k.fx_px,
             k.fy_px, k.cx_px, k.cy_px, median_px);
}

void print_failures(const AnchorRoom& room, const AnchorRoomReport& report) {
  for (std::size_t i = 0; i < report.frames.size(); ++i) {
    for (const LocatedView* view : {&report.frames[i].left, &report.frames[i].right}) {
      const char* side = view == &report.frames[i].left ? "left" : "right";
      if (!view->located) {
        fmt::print("  frame {} {}: {} ({} key points)\n", room.frames[i].id, side, view->failure,
                   room.frames[i].left_px.size());
      } else if (view->wrong) {
        fmt::print("  frame {} {}: WRONG by {:.1f} mm, {:.3f} deg ({} inliers)\n", room.frames[i].id, side,
                   1e3 * view->error_m, rad_to_deg(view->error_rad), view->inliers);
      }
    }
  }
}

/// [P, table "Markers"]: stereo rig, one image against Kalibr's many.
void print_table(const AnchorRoomReport& report) {
  constexpr const char* kRow = "  {:<42} {:>12} {:>12} {:>8}\n";
  fmt::print("\nmarkers on the stereo rig\n");
  fmt::print(kRow, "", "baseline cm", "reproj. px", "std cm");
  fmt::print(kRow, "paper, 100 AprilTags, 1 image", "12.01", "0.62", "0.13");
  fmt::print(kRow, "paper, 40 CCTags, 1 image", "12.11", "0.31", "0.04");
  fmt::print(kRow, "Kalibr, 150 images (from the paper)", "12.09", "0.18", "0.01");
  double markers = 0;
  for (const FrameResult& frame : report.frames) markers += frame.left.inliers;
  fmt::print(kRow,
             fmt::format("ours, {:.0f} CCTags, 1 image, {} times", markers / static_cast<double>(report.frames.size()),
                         report.frames.size()),
             fmt::format("{:.3f}", 0.1 * report.mean_mm), fmt::format("{:.2f}", report.rms_px),
             fmt::format("{:.3f}", 0.1 * report.std_mm));
  fmt::print(kRow, "joint fit of all frames (reference)", fmt::format("{:.3f}", 0.1 * report.joint_mm), "", "");
}

void print(const AnchorRoom& room, const AnchorRoomReport& report) {
  const std::size_t n = report.frames.size();
  fmt::print("stereo pair, fitted to the file's map and poses\n");
  print_camera("left", report.pair.left, report.pair.median_left_px);
  print_camera("right", report.pair.right, report.pair.median_right_px);
  const Vec3 rotation = so3_log(report.pair.T_right_left.R);
  const Vec3& t = report.pair.T_right_left.t;
  fmt::print("  T_right_left  rotation ({:.6f}, {:.6f}, {:.6f}) rad  translation ({:.6f}, {:.6f}, {:.6f}) m\n",
             rotation.x(), rotation.y(), rotation.z(), t.x(), t.y(), t.z());
  fmt::print("\nframes {}, with 8 markers or more {}\n", n, report.frames_with_8_markers);
  fmt::print("located alone, no prior: left {}, right {}; wrong {}; both solved jointly {}\n", report.located_left,
             report.located_right, report.wrong, report.solved);
  print_failures(room, report);
  fmt::print("time of one location: median {:.2f} ms, 95 % {:.2f} ms, most {:.2f} ms\n", report.median_ms,
             report.percentile95_ms, report.max_ms);
  fmt::print("single-shot baseline: mean {:.3f} mm, standard deviation {:.3f} mm; joint fit {:.3f} mm\n",
             report.mean_mm, report.std_mm, report.joint_mm);
  print_table(report);
}

}  // namespace

nlohmann::json AnchorRoomReport::json() const {
  return {{"frames", frames.size()},
          {"frames_with_8_markers", frames_with_8_markers},
          {"located_left", located_left},
          {"located_right", located_right},
          {"wrong", wrong},
          {"solved", solved},
          {"baseline_mm", {{"joint", joint_mm}, {"mean", mean_mm}, {"std", std_mm}}},
          {"rms_px", rms_px},
          {"locate_ms", {{"median", median_ms}, {"p95", percentile95_ms}, {"max", max_ms}}}};
}

void add_evaluate_anchor_room(CLI::App& evaluate, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = evaluate.add_subcommand(
      "anchor-room", "Locate every key-frame of the paper's released room, and its stereo baseline from single shots");
  command->add_option("FILE", arguments->file, "map YAML of the paper's authors")->required();
  command->add_option("--map", arguments->map,
                      "use this map of the room (*.room) instead of the file's, e.g. one baked from its key points");
  command->add_option("--json", arguments->json, "write the figures here");
  command->add_option("--map-sigma", arguments->map_sigma_mm, "standard deviation of the map's points, mm per axis")
      ->check(number_between(0.0, 100.0, "mm"))
      ->capture_default_str();
  command
      ->add_option("--sigma-px", arguments->options.sigma_px,
                   "standard deviation of the key points, px per axis; 0: from the joint fit")
      ->check(number_between(0.0, 10.0, "px"))
      ->capture_default_str();
  command->add_option("--seed", arguments->options.seed, "order in which triangles are tried")->capture_default_str();
  command->add_option("--threads", arguments->options.threads, "results do not depend on it")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->callback([arguments, &exit_code] {
    arguments->options.map_sigma_m = 1e-3 * arguments->map_sigma_mm;
    const AnchorRoom room = parse_anchor_room(arguments->file.string(), read_text(arguments->file));
    std::optional<MapData> map;
    if (!arguments->map.empty()) map = to_map_data(load_map(arguments->map).map);
    const AnchorRoomReport report = evaluate_anchor_room(room, arguments->options, map ? &*map : nullptr);
    print(room, report);
    if (!arguments->json.empty()) write_atomic(arguments->json, report.json().dump(2) + "\n");
    fmt::print("\n{}\n",
               report.passes()
                   ? "PASS"
                   : "FAIL: below the bars (99.5 % located, 0 wrong; 0.1 mm and 0.55 mm, with --map 0.45 mm)");
    if (!report.passes()) exit_code = 2;
  });
}

}  // namespace roomcal::tools
