#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "tools/evaluate/stereo_fit.h"
#include "tools/map/anchor_room_file.h"
#include "tools/map/map_data.h"

namespace roomcal::tools {

struct AnchorRoomOptions {
  /// Per axis; the released map states none. Zero: exact, as the joint fit takes it, so that both weigh alike.
  double map_sigma_m = 0;
  double sigma_px = 0;  ///< of a key point per axis; 0: as the joint fit's residuals say
  uint32_t seed = 1;
  unsigned threads = 2;
};

/// What became of one camera of one key-frame.
struct LocatedView {
  bool located = false;
  bool wrong = false;  ///< more than 5 cm or 1 degree from the file's pose
  double error_m = 0;
  double error_rad = 0;
  int inliers = 0;
  int hypotheses = 0;
  double time_ms = 0;
  std::string failure;
};

struct FrameResult {
  LocatedView left;
  LocatedView right;
  bool solved = false;
  double baseline_mm = 0;
  double sum2_px2 = 0;  ///< of the joint solution's residuals
  std::size_t residuals = 0;
};

struct AnchorRoomReport {
  StereoPair pair;
  std::vector<FrameResult> frames;
  std::size_t frames_with_8_markers = 0;
  std::size_t located_left = 0;
  std::size_t located_right = 0;
  std::size_t wrong = 0;
  std::size_t solved = 0;  ///< frames with a joint solution of both cameras
  double joint_mm = 0;
  double mean_mm = 0;
  double std_mm = 0;
  double rms_px = 0;  ///< length of the residual (both axes), all frames' joint solutions
  double median_ms = 0;
  double percentile95_ms = 0;
  double max_ms = 0;

  nlohmann::json json() const;
  bool with_given_map = false;  ///< instead of the file's points

  /// The bars: >= 99.5 % located, none wrong; with the file's map the mean within 0.1 mm of the joint fit and the
  /// spread <= 0.55 mm, with a baked one the spread below 0.45 mm.
  bool passes() const;
};

/// Locates both cameras of every key-frame alone and without a prior, then solves each frame's pair in one shot.
/// @param given_map  the room's map to use instead of the file's points, e.g. baked from the file's key points.
/// @throws ToolError if that map is of another room.
AnchorRoomReport evaluate_anchor_room(const AnchorRoom& room, const AnchorRoomOptions& options,
                                      const MapData* given_map = nullptr);

/// `roomcal evaluate anchor-room FILE [--map M.room] [--json F] [--map-sigma MM] [--seed N] [--threads N]`; exit 2
/// below the bars.
void add_evaluate_anchor_room(CLI::App& evaluate, int& exit_code);

}  // namespace roomcal::tools
