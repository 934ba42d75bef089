#include "tools/map/compare.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "tools/align/triangle_match.h"

namespace roomcal::tools {

namespace {

std::vector<SpacePoint> points_of(const MapData& data) {
  std::vector<SpacePoint> points;
  for (const map::MapMarker& marker : data.markers) points.push_back({marker.p_room, Mat33::Zero()});
  return points;
}

class MapComparer {
 public:
  MapComparer(const MapData& a, const MapData& b, const CompareOptions& options)
      : a_(a), b_(b), options_(options), points_a_(points_of(a)), points_b_(points_of(b)) {}

  std::optional<MapComparison> run() {
    TriangleMatchOptions match_options;
    match_options.slack_m = options_.slack_m;
    match_options.max_triangles = 1000;
    const auto match = match_points(points_a_, points_b_, match_options);
    // Of two rooms, some markers always come to lie on each other; then another place has nearly as many.
    if (!match || 2 * match->pairs.size() <= 3 * match->second_best) return std::nullopt;
    comparison_.T_a_b = match->T_a_b;
    settle();
    if (comparison_.matched.size() < 3) return std::nullopt;
    measure();
    compare_planes();
    return comparison_;
  }

 private:
  void collect(std::vector<Vec3>& p_a, std::vector<Vec3>& p_b) const {
    for (const auto& [i, j] : comparison_.matched) {
      p_a.push_back(points_a_[i].p);
      p_b.push_back(points_b_[j].p);
    }
  }

  void settle() {
    constexpr int kRounds = 20;
    for (int round = 0; round < kRounds; ++round) {
      // With unit covariances chi2 is the squared distance.
      const PointPairs pairs =
          pair_points(points_a_, points_b_, comparison_.T_a_b, 1, options_.gate_m * options_.gate_m);
      if (pairs == comparison_.matched || pairs.size() < 3) break;
      comparison_.matched = pairs;
      std::vector<Vec3> p_a, p_b;
      collect(p_a, p_b);
      comparison_.T_a_b = fit_rigid(p_a, p_b);
    }
  }

  void measure() {
    std::vector<Vec3> p_a, p_b;
    collect(p_a, p_b);
    double sum = 0, sum2 = 0;
    for (std::size_t i = 0; i < p_a.size(); ++i) {
      const double d_m = (comparison_.T_a_b * p_b[i] - p_a[i]).norm();
      comparison_.distance_m.push_back(d_m);
      sum += d_m;
      sum2 += d_m * d_m;
      comparison_.max_m = std::max(comparison_.max_m, d_m);
    }
    const auto n = static_cast<double>(p_a.size());
    comparison_.mean_m = sum / n;
    comparison_.rms_m = std::sqrt(sum2 / n);
    comparison_.scale_a_b = fit_scale(p_a, p_b, comparison_.T_a_b);
    for (Vec3& p : p_b) p *= comparison_.scale_a_b;
    const SE3 T = fit_rigid(p_a, p_b);
    double scaled2 = 0;
    for (std::size_t i = 0; i < p_a.size(); ++i) scaled2 += (T * p_b[i] - p_a[i]).squaredNorm();
    comparison_.rms_after_scale_m = std::sqrt(scaled2 / n);
  }

  /// The plane of b that holds most of the markers of each plane of a.
  void compare_planes() {
    std::vector<std::vector<std::size_t>> votes(a_.planes.size(), std::vector<std::size_t>(b_.planes.size(), 0));
    for (const auto& [i, j] : comparison_.matched) {
      const int plane_a = a_.markers[i].plane, plane_b = b_.markers[j].plane;
      if (plane_a >= 0 && plane_b >= 0) ++votes[static_cast<std::size_t>(plane_a)][static_cast<std::size_t>(plane_b)];
    }
    for (std::size_t a = 0; a < votes.size(); ++a) {
      const auto most = std::max_element(votes[a].begin(), votes[a].end());
      if (most == votes[a].end() || *most < 3) continue;
      comparison_.planes.push_back(difference(a, static_cast<std::size_t>(most - votes[a].begin())));
    }
  }

  PlaneDifference difference(std::size_t a, std::size_t b) const {
    const map::MapPlane& plane_a = a_.planes[a].plane;
    const Vec3 normal_b = comparison_.T_a_b.R * b_.planes[b].plane.normal_room;
    PlaneDifference out{a, b, std::atan2(plane_a.normal_room.cross(normal_b).norm(), plane_a.normal_room.dot(normal_b)),
                        0};
    double sum = 0, count = 0;
    for (std::size_t j = 0; j < b_.markers.size(); ++j) {
      if (b_.markers[j].plane != static_cast<int>(b)) continue;
      sum += plane_a.normal_room.dot(comparison_.T_a_b * points_b_[j].p) + plane_a.d_m;
      ++count;
    }
    out.offset_m = count > 0 ? sum / count : 0;
    return out;
  }

  const MapData& a_;
  const MapData& b_;
  const CompareOptions& options_;
  std::vector<SpacePoint> points_a_, points_b_;
  MapComparison comparison_;
};

}  // namespace

std::optional<MapComparison> compare_maps(const MapData& a, const MapData& b, const CompareOptions& options) {
  return MapComparer(a, b, options).run();
}

}  // namespace roomcal::tools
