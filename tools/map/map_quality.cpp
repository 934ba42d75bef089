#include "tools/map/map_quality.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace roomcal::tools {

using nlohmann::ordered_json;

namespace {

std::vector<PlaneQuality> measure_planes(const MapData& data) {
  std::vector<PlaneQuality> planes(data.planes.size());
  for (const map::MapMarker& marker : data.markers) {
    if (marker.plane < 0) continue;
    const auto p = static_cast<std::size_t>(marker.plane);
    const map::MapPlane& plane = data.planes[p].plane;
    const double off_m = std::abs(plane.normal_room.dot(marker.p_room) + plane.d_m);
    PlaneQuality& quality = planes[p];
    ++quality.markers;
    quality.rms_m += off_m * off_m;
    if (off_m < quality.max_m) continue;
    quality.max_m = off_m;
    quality.worst_id = marker.id;
  }
  for (PlaneQuality& plane : planes)
    plane.rms_m = std::sqrt(plane.rms_m / static_cast<double>(std::max<std::size_t>(1, plane.markers)));
  return planes;
}

/// Where the ray through the middle of a sample's image first meets an outline: where a marker would be seen.
std::optional<std::pair<std::size_t, Vec3>> looked_at(const MapData& data, const SE3& T_room_cam) {
  std::optional<std::pair<std::size_t, Vec3>> best;
  double nearest_m = 1e9;
  const Vec3 ray = T_room_cam.R.col(2);
  for (std::size_t p = 0; p < data.planes.size(); ++p) {
    const map::MapPlane& plane = data.planes[p].plane;
    const double slope = plane.normal_room.dot(ray);
    const double range_m = -(plane.normal_room.dot(T_room_cam.t) + plane.d_m) / slope;
    if (slope > -0.05 || range_m <= 0 || range_m >= nearest_m) continue;
    nearest_m = range_m;
    best = {p, T_room_cam.t + range_m * ray};
  }
  return best;
}

bool is_weak(const SampleView& view, const CoverageOptions& options) {
  return !view.located || view.markers < options.enough_markers;
}

/// Weak views by the plane they look at, the plane with most of them first.
void advise_coverage(const MapData& data, const MapQuality& quality, const CoverageOptions& options,
                     std::vector<std::string>& advice) {
  struct Weak {
    std::size_t plane = 0, views = 0;
    Vec3 sum_room = Vec3::Zero();
  };
  std::vector<Weak> weak(data.planes.size());
  for (std::size_t p = 0; p < weak.size(); ++p) weak[p].plane = p;
  for (const SampleView& view : quality.coverage.views) {
    if (!is_weak(view, options)) continue;
    const auto hit = looked_at(data, view.T_room_cam);
    if (!hit) continue;
    ++weak[hit->first].views;
    weak[hit->first].sum_room += hit->second;
  }
  std::stable_sort(weak.begin(), weak.end(), [](const Weak& a, const Weak& b) { return a.views > b.views; });
  constexpr std::size_t kMost = 3;
  for (std::size_t i = 0; i < std::min(kMost, weak.size()) && weak[i].views > 0; ++i) {
    const Vec3 mean_room = weak[i].sum_room / static_cast<double>(weak[i].views);
    const Vec3 at = (10 * mean_room).array().round().matrix() / 10 + Vec3::Zero();  // adding 0: no negative zero
    advice.push_back(fmt::format(
        "add markers on plane {} around ({:.1f}, {:.1f}, {:.1f}) m: {} of {} sample views that look "
        "there see fewer than {} or are not located",
        weak[i].plane, at.x(), at.y(), at.z(), weak[i].views, quality.coverage.views.size(), options.enough_markers));
  }
}

void advise(const MapData& data, const CoverageOptions& options, MapQuality& quality) {
  advise_coverage(data, quality, options, quality.advice);
  // Half of the difference of two places is what noise must not reach; maps and devices stay below 10 mm.
  constexpr double kAlike_m = 0.02;
  if (quality.uniqueness && quality.uniqueness->worst_m < kAlike_m) {
    quality.advice.push_back(
        fmt::format("move marker {} or one of its neighbours by 5 cm: the places around {} and {} "
                    "look alike within {:.0f} mm",
                    quality.uniqueness->worst_id, quality.uniqueness->worst_id, quality.uniqueness->worst_other_id,
                    1e3 * quality.uniqueness->worst_m));
  }
  constexpr double kFlat_m = 0.005;
  for (std::size_t p = 0; p < quality.planes.size(); ++p) {
    if (quality.planes[p].rms_m < kFlat_m) continue;
    quality.advice.push_back(
        fmt::format("plane {} is not flat ({:.1f} mm RMS, marker {} is off by {:.1f} mm): LiDARs should not rely on it",
                    p, 1e3 * quality.planes[p].rms_m, quality.planes[p].worst_id, 1e3 * quality.planes[p].max_m));
  }
}

ordered_json coverage_json(const Coverage& c) {
  return {{"views", c.views.size()},
          {"seen_share", c.seen_share},
          {"located_share", c.located_share},
          {"median_sigma_mm", 1e3 * c.median_sigma_m},
          {"median_sigma_deg", rad_to_deg(c.median_sigma_rad)},
          {"least_gap", c.least_gap},
          {"median_gap", c.median_gap}};
}

ordered_json uniqueness_json(const std::optional<Uniqueness>& u) {
  if (!u) return nullptr;
  return {{"neighbours", u->neighbours},
          {"worst_mm", 1e3 * u->worst_m},
          {"worst_ids", {u->worst_id, u->worst_other_id}},
          {"median_mm", 1e3 * u->median_m}};
}

}  // namespace

MapQuality measure_map_quality(const MapData& data, const CoverageOptions& options) {
  MapQuality quality;
  quality.planes = measure_planes(data);
  quality.coverage = measure_coverage(data, options);
  quality.uniqueness = measure_uniqueness(data.markers);
  advise(data, options, quality);
  return quality;
}

ordered_json map_quality_json(const MapQuality& quality) {
  ordered_json planes = ordered_json::array();
  for (const PlaneQuality& p : quality.planes) {
    planes.push_back(
        {{"markers", p.markers}, {"rms_mm", 1e3 * p.rms_m}, {"max_mm", 1e3 * p.max_m}, {"worst_id", p.worst_id}});
  }
  return {{"planes", planes},
          {"coverage", coverage_json(quality.coverage)},
          {"uniqueness", uniqueness_json(quality.uniqueness)},
          {"advice", quality.advice}};
}

std::string map_quality_text(const MapQuality& quality) {
  const Coverage& c = quality.coverage;
  std::string text = fmt::format(
      "coverage: of {} looks of a 77 degree camera {:.0f} % see enough markers, {:.0f} % are located alone, to {:.2f} "
      "mm and {:.4f} deg (median)\n",
      c.views.size(), 100 * c.seen_share, 100 * c.located_share, 1e3 * c.median_sigma_m,
      rad_to_deg(c.median_sigma_rad));
  text += fmt::format(
      "uniqueness: the second-best pose stays {:.0f} behind in log-likelihood at the least, {:.0f} in "
      "the median",
      c.least_gap, c.median_gap);
  if (quality.uniqueness) {
    text += fmt::format("; places of {} markers differ by {:.0f} mm at the least (ids {} and {})",
                        quality.uniqueness->neighbours + 1, 1e3 * quality.uniqueness->worst_m,
                        quality.uniqueness->worst_id, quality.uniqueness->worst_other_id);
  }
  text += "\n";
  for (const std::string& line : quality.advice) text += "advice: " + line + "\n";
  return text;
}

}  // namespace roomcal::tools
