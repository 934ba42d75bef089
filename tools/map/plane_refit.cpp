#include "tools/map/plane_refit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "runtime/map/plane_error.h"
#include "tools/map/structure.h"

namespace roomcal::tools {

namespace {

using map::MapMarker;
using map::MapPlane;

constexpr double kExact_m = 1e-6;
constexpr double kSignificant = 2;  // standard deviations of a chi-square

Vec3 centroid_of(const std::vector<MapMarker>& markers, const PlaneMembers& members) {
  Vec3 sum = Vec3::Zero();
  for (const std::size_t i : members) sum += markers[i].p_room;
  return sum / static_cast<double>(members.size());
}

/// Variance of the markers' distances beyond what their own covariances explain; 0 if that is chance.
double excess_m2(const std::vector<MapMarker>& markers, const PlaneMembers& members, const MapPlane& plane) {
  const auto n = static_cast<double>(members.size());
  if (members.size() <= 3) return 0;
  double own = 0;
  for (const std::size_t i : members) own += plane.normal_room.dot(markers[i].cov_m2 * plane.normal_room) / n;
  const double seen = plane.rms_m * plane.rms_m * n / (n - 3);  // three degrees of freedom went into the plane
  return seen > own * (1 + kSignificant * std::sqrt(2 / (n - 3))) ? seen - own : 0;
}

}  // namespace

void fit_plane(const std::vector<MapMarker>& markers, const PlaneMembers& members, MapPlane& plane) {
  const Vec3 centroid = centroid_of(markers, members);
  Mat33 scatter = Mat33::Zero();
  for (const std::size_t i : members) {
    const Vec3 arm = markers[i].p_room - centroid;
    scatter += arm * arm.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Mat33> spread(scatter / static_cast<double>(members.size()));
  plane.normal_room = spread.eigenvectors().col(0);
  plane.d_m = -plane.normal_room.dot(centroid);
  plane.rms_m = std::sqrt(std::max(0.0, spread.eigenvalues()[0]));
}

Mat33 plane_covariance(const std::vector<MapMarker>& markers, const PlaneMembers& members, const MapPlane& plane) {
  // delta = -(A' A)^-1 A' e with the levers as rows of A and e the markers' errors along the normal.
  Mat33 AtA = Mat33::Zero(), middle = Mat33::Zero();
  const double excess = excess_m2(markers, members, plane);
  for (const std::size_t i : members) {
    const Vec3 lever = map::plane_lever(plane.normal_room, markers[i].p_room);
    AtA += lever * lever.transpose();
    middle += (plane.normal_room.dot(markers[i].cov_m2 * plane.normal_room) + excess) * lever * lever.transpose();
  }
  const Eigen::LDLT<Mat33> solver(AtA);
  const Mat33 left = solver.solve(middle);
  const Mat33 cov = solver.solve(left.transpose());
  double worst_m2 = 0;
  for (const std::size_t i : members) {
    const Vec3 lever = map::plane_lever(plane.normal_room, markers[i].p_room);
    worst_m2 = std::max(worst_m2, lever.dot(cov * lever));
  }
  if (!(worst_m2 > kExact_m * kExact_m)) return Mat33::Zero();
  return 0.5 * (cov + cov.transpose());
}

void refit_planes(MapData& data) {
  for (std::size_t k = 0; k < data.planes.size(); ++k) {
    PlaneMembers members;
    for (std::size_t i = 0; i < data.markers.size(); ++i)
      if (data.markers[i].plane == static_cast<int>(k)) members.push_back(i);
    if (members.size() < 3) continue;
    MapPlane& plane = data.planes[k].plane;
    const Vec3 side = plane.normal_room;
    fit_plane(data.markers, members, plane);
    if (plane.normal_room.dot(side) < 0) {
      plane.normal_room = -plane.normal_room;
      plane.d_m = -plane.d_m;
    }
    plane.cov = plane_covariance(data.markers, members, plane);
  }
  find_structure(data);
}

}  // namespace roomcal::tools
