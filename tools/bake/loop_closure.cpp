#include "tools/bake/loop_closure.h"

#include <algorithm>
#include <map>
#include <set>

namespace roomcal::tools {

namespace {

class LoopFinder {
 public:
  LoopFinder(const Survey& survey, const std::vector<std::vector<StereoPoint>>& stereo, const TrackOptions& track,
             const LoopOptions& options, Reconstruction& map)
      : survey_(survey), stereo_(stereo), track_(track), options_(options), map_(map), place_(map.views.size()) {
    for (std::size_t i = 0; i < map.order.size(); ++i) place_[map.order[i]] = i;
    list_viewers();
  }

  std::size_t run() {
    std::size_t joined = 0;
    for (const std::size_t view : map_.order) {
      const std::size_t far = most_shared(view);
      if (far != kNone) joined += join(view, far);
    }
    return joined;
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  void list_viewers() {
    viewers_.resize(map_.points.size());
    const auto sights = collect_sights(map_);
    for (std::size_t p = 0; p < sights.size(); ++p) {
      for (const PointSight& sight : sights[p]) viewers_[p].insert(sight.view);
    }
  }

  bool all_far(std::size_t point, std::size_t view) const {
    return std::all_of(viewers_[point].begin(), viewers_[point].end(), [&](std::size_t other) {
      const auto apart = static_cast<long>(place_[view]) - static_cast<long>(place_[other]);
      return static_cast<std::size_t>(std::abs(apart)) > options_.far_apart;
    });
  }

  /// The far view with most of the points that this one misses.
  std::size_t most_shared(std::size_t view) const {
    const SE3 T_left_room = map_.views[view].T_room_left.inverse();
    std::map<std::size_t, std::size_t> shared;
    for (std::size_t p = 0; p < map_.points.size(); ++p) {
      if (!map_.alive[p] || viewers_[p].empty() || !all_far(p, view)) continue;
      Vec2 px;
      if (!map_.rig.project(kLeft, T_left_room * map_.points[p].p, px).ok() || !map_.rig.in_image(kLeft, px, 0))
        continue;
      for (const std::size_t far : viewers_[p]) ++shared[far];
    }
    std::size_t best = kNone, most = options_.min_shared - 1;
    for (const auto& [far, count] : shared) {
      if (count <= most) continue;
      best = far;
      most = count;
    }
    return best;
  }

  std::size_t join(std::size_t view, std::size_t far) {
    std::vector<SpacePoint> in_far, in_view;
    std::vector<std::size_t> far_points;
    for (std::size_t p = 0; p < map_.points.size(); ++p) {
      if (!map_.alive[p] || !viewers_[p].contains(far)) continue;
      far_points.push_back(p);
      in_far.push_back(map_.points[p]);
    }
    for (const StereoPoint& point : stereo_[view]) in_view.push_back({point.p_left, point.cov_m2});
    const auto match = match_points(in_far, in_view, track_.match);
    if (!match || match->pairs.size() < options_.min_shared || match->pairs.size() <= match->second_best + 1) return 0;
    std::size_t joined = 0;
    for (const auto& [i, j] : match->pairs) joined += join_pair(view, far_points[i], stereo_[view][j]);
    return joined;
  }

  bool join_pair(std::size_t view, std::size_t far_point, const StereoPoint& seen) {
    const int here = map_.views[view].point[kLeft][seen.left];
    if (here == kNoPoint || here != map_.views[view].point[kRight][seen.right]) return false;
    const auto near_point = static_cast<std::size_t>(here);
    if (near_point == far_point || !join_points(map_, far_point, near_point)) return false;
    viewers_[far_point].merge(viewers_[near_point]);
    viewers_[near_point].clear();
    return true;
  }

  const Survey& survey_;
  const std::vector<std::vector<StereoPoint>>& stereo_;
  const TrackOptions& track_;
  const LoopOptions& options_;
  Reconstruction& map_;
  std::vector<std::size_t> place_;
  std::vector<std::set<std::size_t>> viewers_;
};

}  // namespace

std::size_t close_loops(const Survey& survey, const std::vector<std::vector<StereoPoint>>& stereo,
                        const TrackOptions& track, const LoopOptions& options, Reconstruction& map) {
  return LoopFinder(survey, stereo, track, options, map).run();
}

std::size_t merge_close_points(Reconstruction& map, const LoopOptions& options) {
  auto sights = collect_sights(map);
  std::size_t merged = 0;
  for (std::size_t a = 0; a < map.points.size(); ++a) {
    for (std::size_t b = a + 1; b < map.points.size() && map.alive[a]; ++b) {
      if (!map.alive[b]) continue;
      const double apart_m = (map.points[a].p - map.points[b].p).norm();
      if (apart_m > std::max(options.merge_m, options.overlap_m)) continue;
      const bool keep_a = sights[a].size() >= sights[b].size();
      const std::size_t kept = keep_a ? a : b, gone = keep_a ? b : a;
      if (apart_m < options.merge_m)
        merge_points(map, kept, gone);
      else if (3 * sights[gone].size() < sights[kept].size())
        remove_point(map, gone);
      else
        continue;
      sights[kept].insert(sights[kept].end(), sights[gone].begin(), sights[gone].end());
      ++merged;
    }
  }
  return merged;
}

bool join_maps(const TrackOptions& options, Reconstruction& map, Reconstruction& other) {
  const std::vector<std::size_t> numbers = all_points(map), other_numbers = all_points(other);
  std::vector<SpacePoint> a, b;
  for (const std::size_t p : numbers) a.push_back(map.points[p]);
  for (const std::size_t p : other_numbers) b.push_back(other.points[p]);
  TriangleMatchOptions wide = options.match;
  wide.max_triangles = 2000;
  wide.slack_m = 0.01;  // both maps bend
  const auto match = match_points(a, b, wide);
  constexpr std::size_t kMinShared = 6;
  if (!match || match->pairs.size() < kMinShared || match->pairs.size() < match->second_best + 3) return false;
  std::vector<int> number(other.points.size(), kNoPoint);
  for (const auto& [i, j] : match->pairs) number[other_numbers[j]] = static_cast<int>(numbers[i]);
  for (const std::size_t p : other_numbers) {
    if (number[p] != kNoPoint) continue;
    const Mat33& R = match->T_a_b.R;
    number[p] =
        static_cast<int>(map.add_point({match->T_a_b * other.points[p].p, R * other.points[p].cov_m2 * R.transpose()}));
  }
  for (const std::size_t v : other.order) {
    map.views[v] = other.views[v];
    map.views[v].T_room_left = match->T_a_b * other.views[v].T_room_left;
    for (std::vector<int>& point : map.views[v].point) {
      for (int& p : point) p = p == kNoPoint ? kNoPoint : number[static_cast<std::size_t>(p)];
    }
    map.order.push_back(v);
  }
  other = {};
  return true;
}

}  // namespace roomcal::tools
