#include "tools/bake/track.h"

#include <algorithm>
#include <set>

#include "tools/bake/bundle.h"
#include "tools/bake/place_view.h"
#include "tools/common/progress.h"

namespace roomcal::tools {

namespace {

/// One map while it grows.
struct GrowingMap {
  Reconstruction map;
  std::size_t adjusted_at = 0;  ///< placed views at the last adjustment
};

class Tracker {
 public:
  Tracker(const Survey& survey, const StereoRig& rig, const std::vector<std::vector<StereoPoint>>& stereo,
          const TrackOptions& options)
      : survey_(survey), rig_(rig), stereo_(stereo), options_(options) {}

  std::vector<Reconstruction> run() {
    Progress progress("track", survey_.views.size());
    for (std::size_t view = 0; view < survey_.views.size(); ++view) {
      take(view);
      progress.step();
    }
    std::vector<Reconstruction> maps;
    for (GrowingMap& growing : maps_) maps.push_back(std::move(growing.map));
    std::stable_sort(maps.begin(), maps.end(),
                     [](const auto& a, const auto& b) { return a.order.size() > b.order.size(); });
    return maps;
  }

 private:
  void take(std::size_t view) {
    if (stereo_[view].size() < options_.min_points) return;
    // The map that took the last view first: surveys are walks.
    for (std::size_t tried = 0; tried < maps_.size(); ++tried) {
      const std::size_t m = (current_ + tried) % maps_.size();
      GrowingMap& growing = maps_[m];
      if (!place_view(survey_, stereo_[view], recent_points(growing.map), options_, growing.map, view) &&
          !place_view(survey_, stereo_[view], all_points(growing.map), options_, growing.map, view)) {
        continue;
      }
      current_ = m;
      grow(growing, view);
      return;
    }
    begin_map(view);
  }

  void begin_map(std::size_t view) {
    GrowingMap growing{start_reconstruction(rig_, survey_), 0};
    growing.map.views[view].placed = true;
    growing.map.order.push_back(view);
    add_new_points(stereo_[view], growing.map, view);
    current_ = maps_.size();
    maps_.push_back(std::move(growing));
  }

  void grow(GrowingMap& growing, std::size_t view) {
    add_new_points(stereo_[view], growing.map, view);
    refresh_points(growing.map, view);
    const std::size_t placed = growing.map.order.size();
    if (placed < 3 || 4 * placed < 5 * growing.adjusted_at) return;
    growing.adjusted_at = placed;
    BundleOptions quick;
    quick.max_iterations = 8;
    quick.sigma_px = {options_.stereo.sigma_px, options_.stereo.sigma_px};
    bundle_adjust(survey_, growing.map, quick);
  }

  /// Points of the view are moved to what all their rays say now.
  void refresh_points(Reconstruction& map, std::size_t view) const {
    const auto sights = collect_recent_sights(map);
    for (const int p : std::set<int>(map.views[view].point[kLeft].begin(), map.views[view].point[kLeft].end())) {
      if (p == kNoPoint) continue;
      const auto i = static_cast<std::size_t>(p);
      if (sights[i].size() > 2) retriangulate(survey_, map, sights[i], options_.stereo.sigma_px, map.points[i]);
    }
  }

  /// As collect_sights(), of the last views only: the cost of a step must not grow with the survey.
  std::vector<std::vector<PointSight>> collect_recent_sights(const Reconstruction& map) const {
    constexpr std::size_t kViews = 30;
    std::vector<std::vector<PointSight>> sights(map.points.size());
    for (std::size_t i = map.order.size() - std::min(kViews, map.order.size()); i < map.order.size(); ++i) {
      const std::size_t v = map.order[i];
      for (const Side side : kBothSides) {
        const std::vector<int>& point = map.views[v].point[side];
        for (std::size_t s = 0; s < point.size(); ++s) {
          if (point[s] != kNoPoint) sights[static_cast<std::size_t>(point[s])].push_back({v, side, s});
        }
      }
    }
    return sights;
  }

  std::vector<std::size_t> recent_points(const Reconstruction& map) const {
    std::set<std::size_t> points;
    for (std::size_t i = map.order.size() - std::min(options_.recent, map.order.size()); i < map.order.size(); ++i) {
      for (const std::vector<int>& seen : map.views[map.order[i]].point) {
        for (const int p : seen) {
          if (p != kNoPoint) points.insert(static_cast<std::size_t>(p));
        }
      }
    }
    return {points.begin(), points.end()};
  }

  const Survey& survey_;
  const StereoRig& rig_;
  const std::vector<std::vector<StereoPoint>>& stereo_;
  const TrackOptions& options_;
  std::vector<GrowingMap> maps_;
  std::size_t current_ = 0;
};

}  // namespace

std::vector<std::vector<StereoPoint>> match_all_stereo(const StereoRig& rig, const Survey& survey,
                                                       const StereoMatchOptions& options) {
  std::vector<std::vector<StereoPoint>> points;
  for (const StereoView& view : survey.views) points.push_back(match_stereo(rig, view, options));
  return points;
}

std::vector<Reconstruction> track(const Survey& survey, const StereoRig& rig,
                                  const std::vector<std::vector<StereoPoint>>& stereo, const TrackOptions& options) {
  return Tracker(survey, rig, stereo, options).run();
}

}  // namespace roomcal::tools
