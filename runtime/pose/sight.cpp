#include "runtime/pose/sight.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace roomcal::pose {
namespace {

bool is_sound(const Observation& o) {
  const bool finite = o.centre_px.allFinite() && o.cov_px2.allFinite() && std::isfinite(o.major_px) &&
                      std::isfinite(o.minor_px) && std::isfinite(o.angle_rad);
  return finite && o.cov_px2(0, 0) > 0 && o.cov_px2(1, 1) > 0 && o.cov_px2.determinant() > 0;
}

/// Singular values of a 2 x 2 matrix, larger first.
Vec2 singular_values(const Mat22& m) {
  const double sum = m.squaredNorm();
  const double det = m.determinant();
  const double large = std::sqrt(0.5 * (sum + std::sqrt(std::max(sum * sum - 4.0 * det * det, 0.0))));
  return {large, large > 0 ? std::abs(det) / large : 0.0};
}

Sight make_sight(const Vec3& bearing_cam, const Mat32& bearing_by_px, const Observation& o, double gate_px) {
  Sight s;
  s.bearing_cam = bearing_cam;
  s.tangent.col(0) = bearing_cam.unitOrthogonal();
  s.tangent.col(1) = bearing_cam.cross(s.tangent.col(0));
  s.rad_per_px = s.tangent.transpose() * bearing_by_px;
  s.cov_rad2 = s.rad_per_px * o.cov_px2 * s.rad_per_px.transpose();
  const double half_trace = 0.5 * s.cov_rad2.trace();
  const double spread = std::sqrt(std::max(half_trace * half_trace - s.cov_rad2.determinant(), 0.0));
  s.sigma_rad = std::sqrt(half_trace + spread);
  s.gate_rad = gate_px * singular_values(s.rad_per_px)[0];
  if (o.major_px > 0 && o.minor_px > 0) {
    const double c = std::cos(o.angle_rad);
    const double sine = std::sin(o.angle_rad);
    Mat22 axes_px;  // semi-axes as columns
    axes_px << 0.5 * c * o.major_px, -0.5 * sine * o.minor_px, 0.5 * sine * o.major_px, 0.5 * c * o.minor_px;
    const Vec2 semi_rad = singular_values(s.rad_per_px * axes_px);
    s.semi_major_rad = semi_rad[0];
    s.cos_slant = semi_rad[1] / semi_rad[0];
  }
  return s;
}

void describe_field(SightSet& set) {
  Vec3 mean = Vec3::Zero();
  std::size_t ellipses = 0;
  for (const Sight& s : set.sights) {
    mean += s.bearing_cam;
    set.max_gate_rad = std::max(set.max_gate_rad, s.gate_rad);
    if (s.semi_major_rad > 0) ++ellipses;
  }
  set.has_ellipses = 4 * ellipses >= 3 * set.sights.size();
  if (mean.norm() > 1e-6) set.axis_cam = mean.normalized();
  for (const Sight& s : set.sights) set.cos_field = std::min(set.cos_field, set.axis_cam.dot(s.bearing_cam));
  set.cos_field = std::max(set.cos_field - set.max_gate_rad, -1.0);
  set.field_sr = 2.0 * kPi * (1.0 - set.cos_field);
}

}  // namespace

std::size_t sights_bytes(std::size_t observations) { return observations * sizeof(Sight) + alignof(std::max_align_t); }

Status make_sights(const camera::Camera& camera, std::span<const Observation> observations, double gate_px,
                   Arena& arena, SightSet& set) {
  set = {};
  if (observations.empty()) return ok_status();
  if (observations.size() > 65532) return {StatusCode::kInvalidArgument, "more than 65532 observations"};
  const std::span<Sight> sights = arena.allocate<Sight>(observations.size());
  if (sights.empty()) return out_of_arena("lines of sight");
  std::size_t count = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!is_sound(observations[i])) {
      return {StatusCode::kInvalidArgument, "an observation is not finite or its covariance not positive"};
    }
    Vec3 bearing_cam;
    Mat32 bearing_by_px;
    if (!camera.unproject(observations[i].centre_px, bearing_cam, &bearing_by_px).ok()) continue;
    sights[count] = make_sight(bearing_cam, bearing_by_px, observations[i], gate_px);
    sights[count++].observation = static_cast<uint16_t>(i);
  }
  set.sights = sights.first(count);
  std::sort(set.sights.begin(), set.sights.end(), [](const Sight& a, const Sight& b) {
    return a.bearing_cam.x() != b.bearing_cam.x() ? a.bearing_cam.x() < b.bearing_cam.x()
                                                  : a.observation < b.observation;
  });
  describe_field(set);
  return ok_status();
}

int nearest_sight(const SightSet& set, const Vec3& direction_cam, double gate_rad) {
  const double low = direction_cam.x() - gate_rad;
  const double high = direction_cam.x() + gate_rad;
  std::size_t first = 0;
  std::size_t span = set.sights.size();
  while (span > 0) {  // branch-light lower bound
    const std::size_t half = span / 2;
    const bool right = set.sights[first + half].bearing_cam.x() < low;
    first = right ? first + half + 1 : first;
    span = right ? span - half - 1 : half;
  }
  double best = gate_rad * gate_rad;
  int found = -1;
  for (std::size_t i = first; i < set.sights.size() && set.sights[i].bearing_cam.x() <= high; ++i) {
    const double d2 = (set.sights[i].bearing_cam - direction_cam).squaredNorm();
    if (d2 > best) continue;
    best = d2;
    found = static_cast<int>(i);
  }
  return found;
}

}  // namespace roomcal::pose
