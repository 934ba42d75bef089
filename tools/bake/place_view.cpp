#include "tools/bake/place_view.h"

#include "tools/bake/resection.h"

namespace roomcal::tools {

namespace {

/// Assignment and pose in turn, the gate narrowing.
bool settle(const Survey& survey, const TrackOptions& options, Reconstruction& map, std::size_t view) {
  const double sigma_px = options.stereo.sigma_px;
  for (const double spread_px : {6.0, 3.0, 1.0, 0.0}) {
    assign_points(survey, map, view, sigma_px, spread_px * sigma_px);
    if (!resect(survey, map, view, sigma_px)) return false;
  }
  const ViewFit fit = judge_view(survey, map, view);
  return fit.in_both >= options.min_points && fit.rms_px < 4 * sigma_px &&
         static_cast<double>(fit.met) >= options.min_met * static_cast<double>(fit.expected);
}

bool is_near_point(const Reconstruction& map, const Vec3& p_room, double distance_m) {
  for (std::size_t p = 0; p < map.points.size(); ++p) {
    if (map.alive[p] && (map.points[p].p - p_room).squaredNorm() < distance_m * distance_m) return true;
  }
  return false;
}

}  // namespace

bool place_view(const Survey& survey, const std::vector<StereoPoint>& stereo, const std::vector<std::size_t>& local,
                const TrackOptions& options, Reconstruction& map, std::size_t view) {
  std::vector<SpacePoint> in_map, in_view;
  for (const std::size_t p : local) in_map.push_back(map.points[p]);
  for (const StereoPoint& point : stereo) in_view.push_back({point.p_left, point.cov_m2});
  const auto match = match_points(in_map, in_view, options.match);
  if (!match || match->pairs.size() < options.min_points || match->pairs.size() <= match->second_best) return false;
  ViewState& state = map.views[view];
  state.T_room_left = match->T_a_b;
  if (!settle(survey, options, map, view)) {
    unplace(map, view);
    return false;
  }
  state.placed = true;
  map.order.push_back(view);
  return true;
}

std::size_t add_new_points(const std::vector<StereoPoint>& stereo, Reconstruction& map, std::size_t view,
                           double min_distance_m) {
  ViewState& state = map.views[view];
  std::size_t added = 0;
  for (const StereoPoint& point : stereo) {
    // A wrong partner would keep the right one out; other views know.
    if (point.ambiguous) continue;
    if (state.point[kLeft][point.left] != kNoPoint || state.point[kRight][point.right] != kNoPoint) continue;
    const Mat33& R = state.T_room_left.R;
    const Vec3 p_room = state.T_room_left * point.p_left;
    if (is_near_point(map, p_room, min_distance_m)) continue;
    const std::size_t p = map.add_point({p_room, R * point.cov_m2 * R.transpose()});
    state.point[kLeft][point.left] = state.point[kRight][point.right] = static_cast<int>(p);
    ++added;
  }
  return added;
}

std::vector<std::size_t> all_points(const Reconstruction& map) {
  std::vector<std::size_t> points;
  for (std::size_t p = 0; p < map.points.size(); ++p) {
    if (map.alive[p]) points.push_back(p);
  }
  return points;
}

}  // namespace roomcal::tools
