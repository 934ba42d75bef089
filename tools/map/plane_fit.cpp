#include "tools/map/plane_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "runtime/map/format.h"
#include "tools/common/random.h"
#include "tools/map/convex.h"
#include "tools/map/plane_refit.h"

namespace roomcal::tools {

namespace {

using Indices = PlaneMembers;
using map::MapMarker;
using map::MapPlane;

double distance_m(const MapPlane& plane, const Vec3& p_room) { return plane.normal_room.dot(p_room) + plane.d_m; }

class PlaneFinder {
 public:
  PlaneFinder(const std::vector<MapMarker>& markers, const PlaneFitOptions& options)
      : markers_(markers),
        options_(options),
        random_(options.seed),
        min_cos_(std::cos(deg_to_rad(options.max_normal_deg))) {}

  /// The plane with most of the markers in `free`, refitted; empty if none has enough.
  Indices best(const Indices& free, MapPlane& plane) {
    Indices members;
    for (int draw = 0; draw < options_.draws && free.size() >= options_.min_markers; ++draw) {
      MapPlane candidate;
      if (!through_random_triple(free, candidate)) continue;
      Indices found = members_of(candidate, free);
      if (found.size() <= members.size()) continue;
      members = std::move(found);
      plane = candidate;
    }
    refit(free, plane, members);
    return is_plane(members) ? members : Indices{};
  }

 private:
  bool through_random_triple(const Indices& free, MapPlane& plane) {
    const Vec3& a = markers_[free[random_.below(free.size())]].p_room;
    const Vec3& b = markers_[free[random_.below(free.size())]].p_room;
    const Vec3& c = markers_[free[random_.below(free.size())]].p_room;
    const Vec3 normal = (b - a).cross(c - a);
    const double twice_area_m2 = normal.norm();
    // A triple that is much narrower than the tolerance allows tilts the plane at will.
    const double longest_m = std::max({(b - a).norm(), (c - a).norm(), (c - b).norm()});
    if (longest_m == 0 || twice_area_m2 / longest_m < 4 * options_.tolerance_m) return false;
    plane.normal_room = normal / twice_area_m2;
    plane.d_m = -plane.normal_room.dot(a);
    return true;
  }

  Indices members_of(const MapPlane& plane, const Indices& free) const {
    Indices members;
    for (const std::size_t i : free) {
      const MapMarker& marker = markers_[i];
      if (std::abs(distance_m(plane, marker.p_room)) > options_.tolerance_m) continue;
      if (marker.has_normal && std::abs(marker.normal_room.dot(plane.normal_room)) < min_cos_) continue;
      members.push_back(i);
    }
    return members;
  }

  Eigen::SelfAdjointEigenSolver<Mat33> spread_of(const Indices& members) const {
    Vec3 centroid = Vec3::Zero();
    for (const std::size_t i : members) centroid += markers_[i].p_room / static_cast<double>(members.size());
    Mat33 scatter = Mat33::Zero();
    for (const std::size_t i : members) {
      const Vec3 arm = markers_[i].p_room - centroid;
      scatter += arm * arm.transpose();
    }
    return Eigen::SelfAdjointEigenSolver<Mat33>(scatter / static_cast<double>(members.size()));
  }

  void refit(const Indices& free, MapPlane& plane, Indices& members) const {
    constexpr int kRounds = 5;
    for (int round = 0; round < kRounds && members.size() >= options_.min_markers; ++round) {
      fit_plane(markers_, members, plane);
      Indices again = members_of(plane, free);
      if (again == members) return;
      members = std::move(again);
    }
  }

  bool is_plane(const Indices& members) const {
    return members.size() >= options_.min_markers &&
           std::sqrt(std::max(0.0, spread_of(members).eigenvalues()[1])) >= options_.min_spread_m;
  }

  const std::vector<MapMarker>& markers_;
  const PlaneFitOptions& options_;
  Random random_;
  double min_cos_;
};

void point_into_room(const std::vector<MapMarker>& markers, const Indices& members, double tolerance_m,
                     MapPlane& plane) {
  double surveyed = 0;
  for (const std::size_t i : members) {
    if (markers[i].has_normal) surveyed += markers[i].normal_room.dot(plane.normal_room);
  }
  double side = 0;  // markers before the plane minus markers behind it
  for (const MapMarker& marker : markers) {
    const double d_m = distance_m(plane, marker.p_room);
    if (std::abs(d_m) > tolerance_m) side += d_m > 0 ? 1 : -1;
  }
  const double vote = surveyed != 0 ? surveyed : side;
  if (vote < 0) {
    plane.normal_room = -plane.normal_room;
    plane.d_m = -plane.d_m;
  }
}

/// Convex hull of the markers' centres, counter-clockwise seen from where the normal points.
std::vector<Vec3> outline_of(const std::vector<MapMarker>& markers, const Indices& members, const MapPlane& plane) {
  const PlaneAxes axes(plane.normal_room, plane.d_m);
  std::vector<Vec2> points;
  for (const std::size_t i : members) points.push_back(axes.to_plane(markers[i].p_room));
  std::vector<Vec3> outline;
  for (const Vec2& p : convex_hull(points)) outline.push_back(axes.to_room(p));
  if (outline.size() > map::kMaxOutline) outline.clear();
  return outline;
}

}  // namespace

std::vector<PlaneData> fit_planes(std::vector<MapMarker>& markers, const PlaneFitOptions& options) {
  Indices free(markers.size());
  for (std::size_t i = 0; i < free.size(); ++i) free[i] = i;
  for (MapMarker& marker : markers) marker.plane = -1;
  PlaneFinder finder(markers, options);
  std::vector<PlaneData> planes;
  while (planes.size() < map::kMaxPlanes) {
    MapPlane plane;
    const Indices members = finder.best(free, plane);
    if (members.empty()) break;
    point_into_room(markers, members, options.tolerance_m, plane);
    plane.cov = plane_covariance(markers, members, plane);
    for (const std::size_t i : members) markers[i].plane = static_cast<int>(planes.size());
    std::erase_if(free, [&](std::size_t i) { return markers[i].plane >= 0; });
    planes.push_back({plane, outline_of(markers, members, plane)});
  }
  return planes;
}

}  // namespace roomcal::tools
