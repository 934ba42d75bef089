#include "tools/bake/scale.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/common/yaml.h"

namespace roomcal::tools {

namespace {

constexpr double kReach_px = 20;
// Detectors set the outer edge of a blurred ring wrong by some hundredths of a pixel.
constexpr double kRadiusBias = 0.0005;
constexpr double kSheetLikeness = 0.01;

class DistanceReader {
 public:
  DistanceReader(std::string name, const Survey& survey, const Reconstruction& map, const std::vector<uint32_t>& ids)
      : name_(std::move(name)), survey_(survey), map_(map), ids_(ids) {}

  std::vector<MeasuredDistance> read(const std::string& text) {
    std::istringstream lines(text);
    std::vector<MeasuredDistance> distances;
    for (std::string line; std::getline(lines, line);) {
      ++line_;
      std::erase_if(line, [](char c) { return c == ' ' || c == '\r' || c == '\t'; });
      if (line.empty() || line[0] == '#' || line.starts_with("a,")) continue;
      distances.push_back(read_line(line));
    }
    if (distances.empty()) fail("no distance in it; expected lines a,b,distance_m[,sigma_m]");
    return distances;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw ToolError(fmt::format("{}:{}: {}", name_, line_, what));
  }

  MeasuredDistance read_line(const std::string& line) const {
    std::vector<std::string> cells;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
    if (cells.size() != 3 && cells.size() != 4) fail("expected a,b,distance_m[,sigma_m]");
    MeasuredDistance distance{point_of(cells[0]), point_of(cells[1])};
    if (!parse_finite(cells[2], distance.distance_m) || distance.distance_m <= 0)
      fail("distance_m: expected metres above 0");
    if (cells.size() == 4 && (!parse_finite(cells[3], distance.sigma_m) || distance.sigma_m <= 0))
      fail("sigma_m: expected metres above 0");
    if (distance.point_a == distance.point_b) fail("both ends are the same marker");
    return distance;
  }

  std::size_t point_of(const std::string& end) const {
    const std::size_t at = end.find('@');
    if (at != std::string::npos) return point_at(end.substr(0, at), end.substr(at + 1));
    double id = -1;
    if (!parse_finite(end, id)) fail(fmt::format("`{}`: expected a marker's id or <pair>@<x>:<y>", end));
    for (std::size_t p = 0; p < ids_.size(); ++p) {
      if (map_.alive[p] && static_cast<double>(ids_[p]) == id) return p;
    }
    fail(fmt::format("the map has no marker {}", end));
  }

  std::size_t point_at(const std::string& view_name, const std::string& place) const {
    const std::size_t colon = place.find(':');
    Vec2 px;
    if (colon == std::string::npos || !parse_finite(place.substr(0, colon), px.x()) ||
        !parse_finite(place.substr(colon + 1), px.y())) {
      fail(fmt::format("`{}`: expected x:y in pixels", place));
    }
    for (std::size_t v = 0; v < survey_.views.size(); ++v) {
      if (survey_.views[v].name != view_name) continue;
      const std::vector<Sighting>& seen = survey_.views[v].seen[kLeft];
      for (std::size_t s = 0; s < seen.size(); ++s) {
        const int p = map_.views[v].point[kLeft][s];
        if (p != kNoPoint && (seen[s].centre_px - px).norm() < kReach_px) return static_cast<std::size_t>(p);
      }
      fail(fmt::format("pair {}: no marker of the map within {} px of {}", view_name, kReach_px, place));
    }
    fail(fmt::format("the survey has no pair {}", view_name));
  }

  std::string name_;
  const Survey& survey_;
  const Reconstruction& map_;
  const std::vector<uint32_t>& ids_;
  std::size_t line_ = 0;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

ScaleEvidence from_distances(const Reconstruction& map, const std::vector<MeasuredDistance>& distances) {
  double sum = 0, weights = 0;
  for (const MeasuredDistance& d : distances) {
    const double in_map_m = (map.points[d.point_a].p - map.points[d.point_b].p).norm();
    const double weight = in_map_m * in_map_m / (d.sigma_m * d.sigma_m);
    sum += weight * d.distance_m / in_map_m;
    weights += weight;
  }
  return {"distances", sum / weights, 1 / std::sqrt(weights)};
}

/// Mean factor and its sigma.
ScaleEvidence combine(const std::vector<ScaleEvidence>& evidence) {
  double sum = 0, weights = 0;
  for (const ScaleEvidence& e : evidence) {
    sum += e.factor / (e.sigma * e.sigma);
    weights += 1 / (e.sigma * e.sigma);
  }
  return {"", sum / weights, 1 / std::sqrt(weights)};
}

double percent(double factor) { return 100 * (factor - 1); }

void hint_at_sheets(ScaleReport& report) {
  const double factor = kSheetRadius_m / *report.marker_radius_m;
  constexpr double kOff = 0.0015;
  if (std::abs(factor - 1) > kSheetLikeness || std::abs(factor - 1) < kOff) return;
  report.off = true;
  report.message = fmt::format(
      "scale is off, if the markers are the {:.0f} mm ones of `roomcal sheets`: they measure {:.3f} mm, so the "
      "baseline "
      "given is {:.2f} % too {}; measure a marker and give --marker-radius, or distances with --distances",
      1e3 * kSheetRadius_m, 1e3 * *report.marker_radius_m, std::abs(percent(factor)), factor > 1 ? "short" : "long");
}

bool looks_like_sheets(const ScaleReport& report) {
  return report.marker_radius_m && std::abs(kSheetRadius_m / *report.marker_radius_m - 1) <= kSheetLikeness;
}

ScaleReport from_calibration(const ScaleEvidence& calibration, const ScaleOptions& options, ScaleReport report) {
  report.source = "stereo calibration";
  report.factor = calibration.factor;
  report.sigma = std::max(calibration.sigma, 0.5 * std::abs(options.scale_as_given - 1));
  report.off = std::abs(options.scale_as_given - 1) > 3 * calibration.sigma;
  report.message = fmt::format(
      "scale from the stereo calibration, which contradicts the images: its baseline says {:+.3f} %, all of it "
      "together "
      "{:+.3f} %; the mean is taken, +- {:.2f} %. Measure distances (--distances) to know better",
      percent(1 / calibration.factor), percent(options.scale_as_given / calibration.factor), 100 * report.sigma);
  return report;
}

}  // namespace

std::vector<MeasuredDistance> read_distances(const std::filesystem::path& path, const Survey& survey,
                                             const Reconstruction& map, const std::vector<uint32_t>& id_of_point) {
  return DistanceReader(path.string(), survey, map, id_of_point).read(read_text(path));
}

ScaleReport judge_scale(const Reconstruction& map, const std::vector<MeasuredDistance>& distances,
                        const std::vector<std::optional<MarkerShape>>& shapes, const ScaleOptions& options) {
  ScaleReport report;
  std::vector<double> radii_m;
  for (const auto& shape : shapes) {
    if (shape) radii_m.push_back(shape->radius_m);
  }
  if (!radii_m.empty()) report.marker_radius_m = median(radii_m);
  if (!distances.empty()) report.evidence.push_back(from_distances(map, distances));
  if (options.marker_radius_m > 0) {
    if (!report.marker_radius_m)
      throw ToolError("--marker-radius: this survey has key points only, no ellipses to measure");
    const double sigma = std::hypot(options.marker_radius_sigma, kRadiusBias);
    report.evidence.push_back({"marker radius", options.marker_radius_m / *report.marker_radius_m, sigma});
  }
  std::vector<ScaleEvidence> all = report.evidence;
  if (all.empty()) {
    if (report.marker_radius_m) hint_at_sheets(report);
    if (options.baseline_sigma == 0) {
      if (report.message.empty()) report.message = "scale from the stereo baseline given; nothing checks it";
      return report;
    }
    const ScaleEvidence calibration{"calibration", 0.5 * (1 + options.scale_as_given), options.baseline_sigma};
    if (!looks_like_sheets(report)) return from_calibration(calibration, options, report);
    report.evidence.push_back(
        {"sheet radius (assumed)", kSheetRadius_m / *report.marker_radius_m, std::hypot(kSheetSigma, kRadiusBias)});
    all = report.evidence;
    all.push_back(calibration);
  }
  const ScaleEvidence by_hand = combine(report.evidence);
  const ScaleEvidence together = combine(all);
  report.source = report.evidence.size() == 2 ? "distances and marker radius" : report.evidence[0].source;
  report.factor = together.factor;
  report.sigma = together.sigma;
  report.off = report.off || std::abs(by_hand.factor - 1) > std::max(3 * by_hand.sigma, 5e-4);
  report.message = fmt::format("scale from {}: the map as the baseline has it was {} {:+.3f} % +- {:.3f} %{}",
                               report.source, "multiplied by", percent(report.factor), 100 * report.sigma,
                               report.off ? "; scale is off: the baseline given is wrong by that" : "");
  return report;
}

}  // namespace roomcal::tools
