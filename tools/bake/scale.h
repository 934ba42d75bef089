#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/bake/marker_shape.h"
#include "tools/bake/reconstruction.h"

namespace roomcal::tools {

/// Outer radius of the markers that `roomcal sheets` prints on A4, and how true printers are to it (relative).
inline constexpr double kSheetRadius_m = 0.085;
inline constexpr double kSheetSigma = 0.001;

/// What something that was measured by hand says about the map's scale.
struct ScaleEvidence {
  std::string source;  ///< "distances", "marker radius" or "sheet radius (assumed)"
  double factor = 1;   ///< the map has to grow by this
  double sigma = 0;
};

struct ScaleReport {
  std::string source = "stereo baseline";
  double factor = 1;  ///< that the map, and the baseline with it, was multiplied by
  double sigma = 0;   ///< of the factor, relative; 0: as good as the calibration's baseline
  bool off = false;   ///< hand measurements or the sheets' radius contradict the baseline given
  std::vector<ScaleEvidence> evidence;
  std::optional<double> marker_radius_m;  ///< mean over the markers, before scaling
  std::string message;                    ///< one line for people
};

struct ScaleOptions {
  double marker_radius_m = 0;           ///< outer radius as printed, measured with a ruler; 0: not known
  double marker_radius_sigma = 0.0005;  ///< relative
  /// Relative. 0: the baseline is trusted as given. Else it is under doubt: where nothing was measured by hand, markers
  /// that look like our own sheets (within 1 %) are weighed against it.
  double baseline_sigma = 0;
  /// With a doubted baseline: ReconstructSummary::scale_as_given. A calibration's numbers are wrong together: whoever
  /// made it looked at a target of known size, so what it measures as a whole is as good as its baseline alone. The map
  /// is made as large as the mean of the two.
  double scale_as_given = 1;
};

/// A distance between two markers' centres that a person measured.
struct MeasuredDistance {
  std::size_t point_a = 0, point_b = 0;  ///< numbers in Reconstruction::points
  double distance_m = 0;
  double sigma_m = 0.001;
};

/// CSV `a,b,distance_m[,sigma_m]`; an end is the marker's id in a map baked from this survey before (it is the same
/// again), or `<pair>@<x>:<y>`, a place in that pair's left image within 20 px of the marker's centre. `#`: comment.
/// @param id_of_point  ids of the map's points.
/// @throws ToolError "file:line: ..." for what cannot be read or names no marker of the map.
std::vector<MeasuredDistance> read_distances(const std::filesystem::path& path, const Survey& survey,
                                             const Reconstruction& map, const std::vector<uint32_t>& id_of_point);

/// Weighs the evidence against each other. Changes nothing.
ScaleReport judge_scale(const Reconstruction& map, const std::vector<MeasuredDistance>& distances,
                        const std::vector<std::optional<MarkerShape>>& shapes, const ScaleOptions& options);

}  // namespace roomcal::tools
