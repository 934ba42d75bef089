#include "tools/bake/quality.h"

#include <algorithm>
#include <cmath>

#include "tools/align/rigid_fit.h"

namespace roomcal::tools {

namespace {

/// The map of every other placed view, adjusted with the pair's calibration held.
Reconstruction adjust_half(const Survey& survey, const Reconstruction& map, const BundleOptions& options,
                           std::size_t half) {
  Reconstruction out = map;
  std::vector<std::size_t> views = map.order;
  std::sort(views.begin(), views.end());
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (i % 2 == half) unplace(out, views[i]);
  }
  BundleOptions held = options;
  held.refine_rig = false;
  held.max_iterations = 20;
  bundle_adjust(survey, out, held);
  return out;
}

bool in_two_views(const std::vector<PointSight>& sights) { return count_views(sights) >= 2; }

/// Points that both halves hold, aligned; the rest stays at -1.
std::vector<double> half_distances(const Survey& survey, const Reconstruction& map, const BundleOptions& options) {
  const Reconstruction even = adjust_half(survey, map, options, 0), odd = adjust_half(survey, map, options, 1);
  const auto sights_even = collect_sights(even), sights_odd = collect_sights(odd);
  std::vector<std::size_t> shared;
  std::vector<Vec3> p_even, p_odd;
  for (std::size_t p = 0; p < map.points.size(); ++p) {
    if (!map.alive[p] || !in_two_views(sights_even[p]) || !in_two_views(sights_odd[p])) continue;
    shared.push_back(p);
    p_even.push_back(even.points[p].p);
    p_odd.push_back(odd.points[p].p);
  }
  std::vector<double> distance_m(map.points.size(), -1);
  if (shared.size() < 4) return distance_m;
  const SE3 T_even_odd = fit_rigid(p_even, p_odd);
  for (std::size_t i = 0; i < shared.size(); ++i) {
    distance_m[shared[i]] = 0.5 * (p_even[i] - T_even_odd * p_odd[i]).norm();
  }
  return distance_m;
}

double rms_of(const Survey& survey, const Reconstruction& map, const std::vector<PointSight>& sights,
              const Vec3& p_room) {
  double sum_px2 = 0;
  for (const PointSight& sight : sights) {
    Vec2 px;
    if (!map.rig.project(sight.side, map.views[sight.view].T_room_left.inverse() * p_room, px).ok()) continue;
    sum_px2 += (px - survey.views[sight.view].seen[sight.side][sight.sighting].centre_px).squaredNorm();
  }
  return std::sqrt(sum_px2 / static_cast<double>(std::max<std::size_t>(1, sights.size())));
}

}  // namespace

std::vector<MarkerQuality> measure_quality(const Survey& survey, const Reconstruction& map,
                                           const std::vector<Mat33>& covariances, const BundleOptions& options) {
  const std::vector<double> held_out_m = half_distances(survey, map, options);
  const auto sights = collect_sights(map);
  std::vector<MarkerQuality> quality;
  for (std::size_t p = 0; p < map.points.size(); ++p) {
    if (!map.alive[p]) continue;
    quality.push_back({p, count_views(sights[p]), sights[p].size(), rms_of(survey, map, sights[p], map.points[p].p),
                       std::sqrt(covariances[p].trace()), held_out_m[p]});
  }
  return quality;
}

}  // namespace roomcal::tools
