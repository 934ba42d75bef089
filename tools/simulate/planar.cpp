#include "tools/simulate/planar.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace roomcal::tools {

Plane make_plane(const std::string& name, const Vec3& point, const Vec3& normal, double albedo) {
  Plane plane;
  plane.name = name;
  plane.origin = point;
  plane.normal = normal.normalized();
  const bool level = std::abs(plane.normal.z()) > 0.7;
  const Vec3 towards = level ? Vec3::UnitY() : Vec3::UnitZ();
  plane.axis_v = (towards - plane.normal * plane.normal.dot(towards)).normalized();
  plane.axis_u = plane.axis_v.cross(plane.normal);
  plane.albedo = albedo;
  return plane;
}

std::vector<Vec3> polygon_of(const Scene& scene, const Plane& wall) {
  std::vector<Vec3> corners;
  for (std::size_t i = 0; i < scene.walls.size(); ++i) {
    for (std::size_t j = i + 1; j < scene.walls.size(); ++j) {
      const Plane &a = scene.walls[i], &b = scene.walls[j];
      if (&a == &wall || &b == &wall) continue;
      Mat33 normals;
      normals << wall.normal.transpose(), a.normal.transpose(), b.normal.transpose();
      if (std::abs(normals.determinant()) < 0.1) continue;
      const Vec3 offsets(wall.normal.dot(wall.origin), a.normal.dot(a.origin), b.normal.dot(b.origin));
      const Vec3 corner = normals.inverse() * offsets;
      const bool in_room = std::all_of(scene.walls.begin(), scene.walls.end(),
                                       [&](const Plane& other) { return other.signed_distance(corner) > -1e-9; });
      if (in_room) corners.push_back(corner);
    }
  }
  Vec3 middle = Vec3::Zero();
  for (const Vec3& corner : corners) middle += corner / static_cast<double>(corners.size());
  const auto angle = [&](const Vec3& corner) {
    return std::atan2((corner - middle).dot(wall.axis_v), (corner - middle).dot(wall.axis_u));
  };
  std::sort(corners.begin(), corners.end(), [&](const Vec3& a, const Vec3& b) { return angle(a) < angle(b); });
  return corners;
}

Body make_box(const std::string& name, const Vec3& centre, const Vec3& half_size, double yaw_rad, double albedo) {
  Body box{name, {}};
  const Mat33 R = Eigen::AngleAxisd(yaw_rad, Vec3::UnitZ()).toRotationMatrix();
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const Vec3 normal = R.col(axis) * side;
      Plane face = make_plane(name, centre + normal * half_size[axis], normal, albedo);
      const double reach = half_size.norm();  // larger than the face; only its tables grow
      face.origin -= reach * (face.axis_u + face.axis_v);
      face.size = Vec2(2 * reach, 2 * reach);
      box.faces.push_back(face);
    }
  }
  return box;
}

double clearance(const Body& body, const Vec3& point_room) {
  double distance = -std::numeric_limits<double>::infinity();
  for (const Plane& face : body.faces) distance = std::max(distance, face.signed_distance(point_room));
  return distance;
}

bool overlap(const Decal& a, const Decal& b, double gap_m) {
  const auto axes = [](const Decal& decal) {
    return std::array<Vec2, 2>{Vec2(std::cos(decal.angle_rad), std::sin(decal.angle_rad)),
                               Vec2(-std::sin(decal.angle_rad), std::cos(decal.angle_rad))};
  };
  const auto axes_a = axes(a), axes_b = axes(b);
  const auto reach = [](const Decal& decal, const std::array<Vec2, 2>& own, const Vec2& along) {
    return decal.half_size.x() * std::abs(own[0].dot(along)) + decal.half_size.y() * std::abs(own[1].dot(along));
  };
  for (const Vec2& along : {axes_a[0], axes_a[1], axes_b[0], axes_b[1]}) {
    const double between = std::abs((a.centre - b.centre).dot(along));
    if (between > reach(a, axes_a, along) + reach(b, axes_b, along) + gap_m) return false;
  }
  return true;
}

}  // namespace roomcal::tools
