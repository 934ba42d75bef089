#include "runtime/pose/image_triangles.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace roomcal::pose {
namespace {

/// Columns 0 and 1 span the plane of the projection, column 2 is the direction opposite to the pole.
Mat33 projection_frame(std::span<const Vec3> bearing_cam) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& b : bearing_cam) mean += b;
  // A panorama has no mean: any axis will do, seams cost a triangle or two.
  const Vec3 axis = mean.norm() > 1e-3 * static_cast<double>(bearing_cam.size()) ? mean.normalized() : Vec3::UnitZ();
  Mat33 frame;
  frame.col(0) = axis.unitOrthogonal();
  frame.col(1) = axis.cross(frame.col(0));
  frame.col(2) = axis;
  return frame;
}

}  // namespace

bool passes(const TriangleFilter& filter, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 edge[3] = {c - b, a - c, b - a};
  double shortest = INFINITY;
  double longest = 0;
  for (const Vec3& e : edge) {
    shortest = std::min(shortest, e.norm());
    longest = std::max(longest, e.norm());
  }
  if (!(shortest > 0) || longest >= filter.max_edge_ratio * shortest) return false;
  const double max_cosine = std::cos(filter.min_angle_rad);
  for (int i = 0; i < 3; ++i) {
    const Vec3& next = edge[(i + 1) % 3];
    const Vec3& last = edge[(i + 2) % 3];
    if (-next.dot(last) >= max_cosine * next.norm() * last.norm()) return false;
  }
  return true;
}

std::size_t image_triangles_bytes(std::size_t bearings) {
  return delaunay_bytes(bearings) + bearings * sizeof(Vec2) + alignof(std::max_align_t);
}

Status image_triangles(std::span<const Vec3> bearing_cam, const TriangleFilter& filter, Arena& arena,
                       std::span<Triple>& triples) {
  triples = {};
  if (bearing_cam.size() < 3) return ok_status();
  const std::span<Vec2> plane = arena.allocate<Vec2>(bearing_cam.size());
  if (plane.empty()) return out_of_arena("image triangles");
  const Mat33 frame = projection_frame(bearing_cam);
  for (std::size_t i = 0; i < plane.size(); ++i) {
    const Vec3 b = frame.transpose() * bearing_cam[i];
    plane[i] = b.head<2>() / std::max(1.0 + b.z(), 1e-6);
  }
  std::span<Triple> all;
  ROOMCAL_TRY(delaunay(plane, arena, all));
  std::size_t count = 0;
  for (Triple t : all) {
    const Vec3& a = bearing_cam[t[0]];
    const Vec3& b = bearing_cam[t[1]];
    const Vec3& c = bearing_cam[t[2]];
    if (!passes(filter, a, b, c)) continue;
    if (a.dot(b.cross(c)) < 0) std::swap(t[1], t[2]);
    all[count++] = t;
  }
  triples = all.first(count);
  return ok_status();
}

}  // namespace roomcal::pose
