#include "runtime/pose/support.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace roomcal::pose {
namespace {

/// Part of the observations that a right pose explains, in the likelihood: clutter and unmapped markers are the rest.
constexpr double kExplained = 0.8;
/// Slant beyond which no detector sees a ring: 85 degrees.
constexpr double kMinCosSlant = 0.087;
/// A camera may stand outside the box of the markers (an open side, a wall without sheets) by so much.
constexpr double kBeyondRoom_m = 1.0;
/// Error of an ellipse's size, as a part of it: 15 px across known to 0.5 px, perspective of a near marker.
constexpr double kSizeTolerance = 0.15;
constexpr double kSlantTolerance = 0.25;  // in cos(slant)

bool faces(const map::IndexedMarker& marker, const Vec3& to_camera_room, double range_m) {
  return !marker.has_normal || marker.normal_room.dot(to_camera_room) > kMinCosSlant * range_m;
}

}  // namespace

Mat22 residual_covariance(const Sight& sight, const map::IndexedMarker& marker, const Mat33& R_room_cam,
                          double range_m) {
  if (marker.sigma_m <= 0) return sight.cov_rad2;
  const Mat32 across_room = R_room_cam * sight.tangent;
  return sight.cov_rad2 + across_room.transpose() * marker.cov_m2 * across_room / (range_m * range_m);
}

Matcher::Matcher(const SightSet& set, const map::TriangleIndex& index) : set_(set), index_(index) {
  const Vec3 size_m = index.high_room() - index.low_room();
  // The markers of one wall make a box without depth: a camera may then stand as far away as the wall is long.
  const Vec3 beyond_m = (Vec3::Constant(size_m.maxCoeff()) - size_m).cwiseMax(kBeyondRoom_m);
  low_room_ = index.low_room() - beyond_m;
  high_room_ = index.high_room() + beyond_m;
}

bool Matcher::looks_like(const Sight& sight, const map::IndexedMarker& marker, const Vec3& to_camera_room,
                         double tolerance) const {
  if (sight.semi_major_rad <= 0 || !marker.has_radius) return true;
  const double range_m = to_camera_room.norm();
  const double predicted_rad = std::atan(marker.radius_m / range_m);
  if (std::abs(sight.semi_major_rad / predicted_rad - 1.0) > tolerance * kSizeTolerance) return false;
  if (!marker.has_normal) return true;
  const double cos_slant = marker.normal_room.dot(to_camera_room) / range_m;
  return std::abs(sight.cos_slant - cos_slant) < tolerance * kSlantTolerance;
}

bool Matcher::is_plausible(const SE3& T_room_cam, const std::array<uint16_t, 3>& sight,
                           const map::MarkerTriple& marker) const {
  const Vec3& c = T_room_cam.t;
  if (!((c - low_room_).minCoeff() > 0 && (high_room_ - c).minCoeff() > 0)) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    const map::IndexedMarker& m = index_.markers()[marker[i]];
    const Vec3 to_camera_room = c - m.p_room;
    if (m.has_normal && m.normal_room.dot(to_camera_room) <= 0) return false;
    if (!looks_like(set_.sights[sight[i]], m, to_camera_room, 1.0)) return false;
  }
  return true;
}

int Matcher::neighbours_seen(const SE3& T_room_cam, const map::MarkerTriple& marker, double gate_scale,
                             int enough) const {
  FixedVector<uint16_t, 3 * map::IndexedMarker::kNeighbours> tried;
  int seen = 0;
  for (const uint16_t vertex : marker) {
    const map::IndexedMarker& centre = index_.markers()[vertex];
    for (std::size_t k = 0; k < centre.neighbours; ++k) {
      const uint16_t number = centre.neighbour[k];
      if (number == marker[0] || number == marker[1] || number == marker[2]) continue;
      if (std::find(tried.begin(), tried.end(), number) != tried.end()) continue;
      static_cast<void>(tried.push_back(number));
      const map::IndexedMarker& m = index_.markers()[number];
      const Vec3 ray_room = m.p_room - T_room_cam.t;
      const double range_m = ray_room.norm();
      if (!faces(m, -ray_room, range_m)) continue;
      const Vec3 direction_cam = T_room_cam.R.transpose() * ray_room / range_m;
      const double gate = gate_scale * (set_.max_gate_rad + 3.0 * m.sigma_m / range_m);
      if (nearest_sight(set_, direction_cam, gate) >= 0 && ++seen >= enough) return seen;
    }
    // Nothing around the first vertex: the others would have to be lucky. One look at one more vertex, then no.
    if (seen == 0 && vertex == marker[1]) return 0;
  }
  return seen;
}

Support Matcher::match(const SE3& T_room_cam, double gate_scale, std::span<uint16_t> marker_of_sight,
                       std::span<double> work) const {
  std::fill(marker_of_sight.begin(), marker_of_sight.end(), kNoMarker);
  const Vec3 axis_room = T_room_cam.R * set_.axis_cam;
  const std::span<double> best_part = work;  // squared residual over squared gate
  int in_field = 0;
  for (std::size_t i = 0; i < index_.markers().size(); ++i) {
    const map::IndexedMarker& m = index_.markers()[i];
    const Vec3 ray_room = m.p_room - T_room_cam.t;
    const double range_m = ray_room.norm();
    if (!(range_m > 0) || axis_room.dot(ray_room) < set_.cos_field * range_m) continue;
    if (!faces(m, -ray_room, range_m)) continue;
    ++in_field;
    const Vec3 direction_cam = T_room_cam.R.transpose() * ray_room / range_m;
    const double map_rad = m.sigma_m / range_m;
    const int s = nearest_sight(set_, direction_cam, gate_scale * (set_.max_gate_rad + 3.0 * map_rad));
    if (s < 0) continue;
    const Sight& sight = set_.sights[static_cast<std::size_t>(s)];
    const double gate =
        gate_scale * std::max(sight.gate_rad, 3.0 * std::sqrt(sight.sigma_rad * sight.sigma_rad + map_rad * map_rad));
    const double part = (sight.bearing_cam - direction_cam).squaredNorm() / (gate * gate);
    if (part > 1.0 || !looks_like(sight, m, -ray_room, 1.5)) continue;
    const auto k = static_cast<std::size_t>(s);
    if (marker_of_sight[k] != kNoMarker && best_part[k] <= part) continue;
    marker_of_sight[k] = static_cast<uint16_t>(i);
    best_part[k] = part;
  }

  Support support;
  const double density_per_sr = std::max(in_field, 1) / set_.field_sr;
  for (std::size_t k = 0; k < set_.sights.size(); ++k) {
    double odds = 1.0 - kExplained;
    if (marker_of_sight[k] != kNoMarker) {
      ++support.inliers;
      const Sight& sight = set_.sights[k];
      const map::IndexedMarker& m = index_.markers()[marker_of_sight[k]];
      const Vec3 p_cam = T_room_cam.R.transpose() * (m.p_room - T_room_cam.t);
      const double range_m = p_cam.norm();
      const Vec2 residual = sight.tangent.transpose() * p_cam / range_m;
      const Mat22 cov = gate_scale * gate_scale * residual_covariance(sight, m, T_room_cam.R, range_m);
      const double det = cov.determinant();
      const double chi2 = (cov(1, 1) * residual[0] * residual[0] - 2.0 * cov(0, 1) * residual[0] * residual[1] +
                           cov(0, 0) * residual[1] * residual[1]) /
                          det;
      odds += kExplained * std::exp(-0.5 * chi2) / (2.0 * kPi * std::sqrt(det) * density_per_sr);
    }
    support.log_likelihood += std::log(odds);
  }
  return support;
}

}  // namespace roomcal::pose
