#include "tools/bake/reconstruct.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "tools/align/rigid_fit.h"
#include "tools/bake/resection.h"
#include "tools/bake/survey_checks.h"
#include "tools/bake/track.h"
#include "tools/common/error.h"

namespace roomcal::tools {

namespace {

using StereoPoints = std::vector<std::vector<StereoPoint>>;

class Reconstructor {
 public:
  Reconstructor(const Survey& survey, const StereoRig& rig, const ReconstructOptions& options,
                ReconstructSummary& summary)
      : survey_(survey), given_rig_(rig), options_(options), summary_(summary) {}

  Reconstruction run() {
    StereoPoints stereo = match_all_stereo(given_rig_, survey_, options_.track.stereo);
    check_stereo(survey_, given_rig_, stereo, options_.track.stereo);
    track_ = options_.track;
    std::vector<Reconstruction> maps = track_at_best_noise(epipolar_sigma_px(stereo), stereo);
    if (maps.empty()) throw ToolError(survey_.source + ": no pair shows enough markers to start a map");
    check_one_room(survey_, maps);
    Reconstruction map = std::move(maps.front());
    fmt::print("track    {} of {} pairs placed, {} points, at {:.2f} px\n", map.order.size(), survey_.views.size(),
               map.alive_count(), track_.stereo.sigma_px);
    find_loops(stereo, map);
    polish(stereo, map);
    refine(stereo, map);
    name_lost(stereo, map);
    return map;
  }

 private:
  void set_noise(double sigma_px) {
    track_.stereo.sigma_px = sigma_px;
    track_.match.slack_m = 0.002 + 0.005 * sigma_px;
    track_.match.start_slack_m = 0.01 + 0.1 * sigma_px;
  }

  /// Tracks with gates as tight as the epipolar distances are. A wrong focal length bends views against each other
  /// without showing there, so a survey that falls apart is tracked again with wider gates. These are believed only if
  /// they bring together what the tighter ones placed in parts: they might as well have thrown two rooms into one.
  std::vector<Reconstruction> track_at_best_noise(double epipolar_px, StereoPoints& stereo) {
    constexpr double kLeast_px = 0.1;
    const double most_px = options_.track.stereo.sigma_px;
    std::vector<Reconstruction> best;
    double best_px = 0;
    for (double sigma_px = std::clamp(1.5 * epipolar_px, kLeast_px, most_px);; sigma_px *= 3) {
      set_noise(std::min(sigma_px, most_px));
      stereo = match_all_stereo(given_rig_, survey_, track_.stereo);
      std::vector<Reconstruction> maps = track(survey_, given_rig_, stereo, track_);
      join(maps);
      if (!maps.empty() && (best.empty() || nearly_all(maps[0].order.size(), placed_in_parts(best)))) {
        best = std::move(maps);
        best_px = track_.stereo.sigma_px;
      }
      if (!best.empty() && nearly_all(best[0].order.size(), count_usable(stereo))) break;
      if (sigma_px >= most_px) break;
    }
    set_noise(std::max(best_px, kLeast_px));
    stereo = match_all_stereo(given_rig_, survey_, track_.stereo);
    return best;
  }

  static bool nearly_all(std::size_t some, std::size_t all) { return 100 * some >= 98 * all; }

  /// Views in maps that are more than a view that fits nowhere.
  static std::size_t placed_in_parts(const std::vector<Reconstruction>& maps) {
    std::size_t placed = 0;
    for (const Reconstruction& map : maps) placed += map.order.size() > 1 ? map.order.size() : 0;
    return placed;
  }

  std::size_t count_usable(const StereoPoints& stereo) const {
    return static_cast<std::size_t>(std::count_if(
        stereo.begin(), stereo.end(), [&](const auto& points) { return points.size() >= track_.min_points; }));
  }

  /// The largest map takes in what it can, again and again: a joined map may carry the next one.
  void join(std::vector<Reconstruction>& maps) const {
    for (bool any = true; any;) {
      any = false;
      for (std::size_t m = 1; m < maps.size(); ++m) any = join_maps(track_, maps[0], maps[m]) || any;
      std::erase_if(maps, [](const Reconstruction& map) { return map.order.empty(); });
    }
  }

  void find_loops(const StereoPoints& stereo, Reconstruction& map) {
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds; ++round) {
      adjust(map, track_.stereo.sigma_px, false, 15);
      const std::size_t joined = close_loops(survey_, stereo, track_, options_.loop, map);
      const std::size_t merged = merge_close_points(map, options_.loop);
      summary_.loops_joined += joined;
      summary_.merged += merged;
      if (joined + merged == 0) break;
    }
    fmt::print("loops    {} points joined by co-visibility, {} merged below {:.0f} mm\n", summary_.loops_joined,
               summary_.merged, 1e3 * options_.loop.merge_m);
  }

  void adjust(Reconstruction& map, double sigma_px, bool refine, int iterations) {
    BundleOptions bundle;
    bundle.sigma_px = {sigma_px, sigma_px};
    bundle.max_iterations = iterations;
    bundle.refine_rig = refine;
    bundle.given_rig = given_rig_;
    bundle.prior = options_.prior;
    summary_.bundle = bundle_adjust(survey_, map, bundle);
  }

  /// A second polish with the pair's calibration free within its prior, from where the first one ended.
  void refine(const StereoPoints& stereo, Reconstruction& map) {
    summary_.sigma_held_px = summary_.sigma_px;
    if (options_.refine_rig == RefineRig::kNever) return;
    const ReconstructSummary held_summary = summary_;
    const Reconstruction held = map;
    summary_.refined = true;
    polish(stereo, map);
    // Perfect calibrations gain a percent or two from a dozen free parameters; wrong ones gain a quarter and more.
    constexpr double kClearly = 0.9;
    const double gain = (summary_.sigma_px[kLeft] + summary_.sigma_px[kRight]) /
                        (held_summary.sigma_px[kLeft] + held_summary.sigma_px[kRight]);
    if (options_.refine_rig == RefineRig::kIfContradicted && gain > kClearly) {
      fmt::print("stereo   calibration believed as given: refining it gains {:.0f} %\n", 100 * std::max(0.0, 1 - gain));
      map = held;
      summary_ = held_summary;
      return;
    }
    fmt::print("stereo   calibration refined: residuals fall by {:.0f} %\n", 100 * (1 - gain));
    summary_.scale_as_given = scale_over(held, map);
  }

  /// `held` is so many times as large as `map`.
  static double scale_over(const Reconstruction& held, const Reconstruction& map) {
    std::vector<Vec3> p_held, p_map;
    for (std::size_t p = 0; p < std::min(held.points.size(), map.points.size()); ++p) {
      if (!held.alive[p] || !map.alive[p]) continue;
      p_held.push_back(held.points[p].p);
      p_map.push_back(map.points[p].p);
    }
    if (p_held.size() < 4) return 1;
    return fit_scale(p_held, p_map, fit_rigid(p_held, p_map));
  }

  /// Assignment and adjustment in turn, with the noise that the last round found.
  void polish(const StereoPoints& stereo, Reconstruction& map) {
    double sigma_px =
        summary_.refined ? std::max(summary_.sigma_px[kLeft], summary_.sigma_px[kRight]) : track_.stereo.sigma_px;
    std::size_t before = 0;
    for (summary_.rounds = 1; summary_.rounds <= options_.max_rounds; ++summary_.rounds) {
      adjust(map, sigma_px, summary_.refined, 25);
      summary_.merged += merge_close_points(map, options_.loop);
      reassign(stereo, map, sigma_px);
      summary_.sigma_px = robust_sigma_px(survey_, map);
      sigma_px = std::max(summary_.sigma_px[kLeft], summary_.sigma_px[kRight]);
      const std::size_t sightings =
          residual_lengths(survey_, map, kLeft).size() + residual_lengths(survey_, map, kRight).size();
      fmt::print("adjust   {} pairs, {} points, {} sightings, sigma {:.3f} {:.3f} px\n", map.order.size(),
                 map.alive_count(), sightings, summary_.sigma_px[kLeft], summary_.sigma_px[kRight]);
      // Some sighting always flickers at a gate.
      if (2000 * std::max(sightings, before) <= 2001 * std::min(sightings, before)) break;
      before = sightings;
    }
    adjust_finally(map);
  }

  void adjust_finally(Reconstruction& map) {
    BundleOptions bundle;
    bundle.sigma_px = summary_.sigma_px;
    bundle.refine_rig = summary_.refined;
    bundle.given_rig = given_rig_;
    bundle.prior = options_.prior;
    summary_.bundle = bundle_adjust(survey_, map, bundle);
    summary_.sigma_px = robust_sigma_px(survey_, map);
  }

  /// Every sighting looks for its point anew; views and points that hang by too little go, new ones come.
  void reassign(const StereoPoints& stereo, Reconstruction& map, double sigma_px) {
    const double gate_sigma_px = std::clamp(1.3 * sigma_px, 0.1, 1.0);
    for (const std::size_t v : std::vector<std::size_t>(map.order)) {
      assign_points(survey_, map, v, gate_sigma_px, 0);
      if (judge_view(survey_, map, v).in_both < track_.min_points) unplace(map, v);
    }
    const std::vector<std::size_t> points = all_points(map);
    for (std::size_t v = 0; v < map.views.size(); ++v) {
      if (map.views[v].placed || stereo[v].size() < track_.min_points) continue;
      place_view(survey_, stereo[v], points, track_, map, v);
    }
    remove_weak_points(map);
    for (const std::size_t v : map.order) add_new_points(stereo[v], map, v, options_.loop.overlap_m);
    for (const std::size_t v : map.order) assign_points(survey_, map, v, gate_sigma_px, 0);
    remove_weak_points(map);
  }

  void remove_weak_points(Reconstruction& map) const {
    const auto sights = collect_sights(map);
    for (std::size_t p = 0; p < map.points.size(); ++p) {
      if (map.alive[p] && count_views(sights[p]) < options_.min_views) map.alive[p] = false;
    }
    for (ViewState& view : map.views) {
      for (std::vector<int>& point : view.point) {
        for (int& p : point) {
          if (p != kNoPoint && !map.alive[static_cast<std::size_t>(p)]) p = kNoPoint;
        }
      }
    }
  }

  void name_lost(const StereoPoints& stereo, const Reconstruction& map) {
    for (std::size_t v = 0; v < map.views.size(); ++v) {
      if (map.views[v].placed) continue;
      (stereo[v].size() < track_.min_points ? summary_.views_without_markers : summary_.views_lost).push_back(v);
    }
  }

  const Survey& survey_;
  StereoRig given_rig_;
  const ReconstructOptions& options_;
  ReconstructSummary& summary_;
  TrackOptions track_;  ///< with the noise that this survey shows
};

}  // namespace

Reconstruction reconstruct(const Survey& survey, const StereoRig& rig, const ReconstructOptions& options,
                           ReconstructSummary& summary) {
  return Reconstructor(survey, rig, options, summary).run();
}

}  // namespace roomcal::tools
