#include "tools/simulate/planar.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "tools/simulate/ray.h"

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

namespace {

std::optional<Vec3> meeting_point(const Plane& a, const Plane& b, const Plane& c) {
  Mat33 normals;
  normals << a.normal.transpose(), b.normal.transpose(), c.normal.transpose();
  if (std::abs(normals.determinant()) < 0.1) return std::nullopt;
  return normals.inverse() * Vec3(a.normal.dot(a.origin), b.normal.dot(b.origin), c.normal.dot(c.origin));
}

}  // namespace

std::vector<Vec3> polygon_of(const Scene& scene, const Plane& wall) {
  if (wall.bounded) {
    return {wall.point({0, 0}), wall.point({wall.size.x(), 0}), wall.point(wall.size), wall.point({0, wall.size.y()})};
  }
  std::vector<Vec3> corners;
  for (std::size_t i = 0; i < scene.walls.size(); ++i) {
    for (std::size_t j = i + 1; j < scene.walls.size(); ++j) {
      const Plane &a = scene.walls[i], &b = scene.walls[j];
      if (&a == &wall || &b == &wall) continue;
      const auto corner = meeting_point(wall, a, b);
      if (!corner) continue;
      const bool in_room = std::all_of(scene.walls.begin(), scene.walls.end(),
                                       [&](const Plane& other) { return other.signed_distance(*corner) > -1e-9; });
      if (in_room) corners.push_back(*corner);
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
  Body box{.name = name, .faces = {}};
  const Mat33 R = Eigen::AngleAxisd(yaw_rad, Vec3::UnitZ()).toRotationMatrix();
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back(centre + R * half_size.cwiseProduct(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const Vec3 normal = R.col(axis) * side;
      Plane face = make_plane(name, centre + normal * half_size[axis], normal, albedo);
      Vec2 low = Vec2::Constant(1e9), high = Vec2::Constant(-1e9);
      for (const Vec3& corner : corners) {
        low = low.cwiseMin(face.coordinates(corner));
        high = high.cwiseMax(face.coordinates(corner));
      }
      face.origin = face.point(low);
      face.size = high - low;
      box.faces.push_back(face);
    }
  }
  bound(box, corners);
  return box;
}

void bound(Body& body, const std::vector<Vec3>& corners) {
  body.centre.setZero();
  for (const Vec3& corner : corners) body.centre += corner / static_cast<double>(corners.size());
  body.reach_m = 0;
  for (const Vec3& corner : corners) body.reach_m = std::max(body.reach_m, (corner - body.centre).norm() + 1e-6);
}

std::vector<Vec3> corners_of(const Body& body) {
  std::vector<Vec3> corners;
  for (std::size_t i = 0; i < body.faces.size(); ++i) {
    for (std::size_t j = i + 1; j < body.faces.size(); ++j) {
      for (std::size_t k = j + 1; k < body.faces.size(); ++k) {
        const auto corner = meeting_point(body.faces[i], body.faces[j], body.faces[k]);
        if (corner && clearance(body, *corner) < 1e-9) corners.push_back(*corner);
      }
    }
  }
  return corners;
}

bool in_free_space(const Scene& scene, const Vec3& point_room) {
  int seen = 0;
  constexpr int kDirections = 24;
  for (int i = 0; i < kDirections; ++i) {
    const double turn = 2 * kPi * (i + 0.37) / kDirections;  // along no wall
    const Vec3 direction(std::cos(turn), std::sin(turn), i % 3 == 0 ? -0.31 : i % 3 == 1 ? 0.03 : 0.23);
    double front = std::numeric_limits<double>::infinity(), behind = front;
    for (const Plane& wall : scene.walls) {
      front = std::min(front, distance_to(wall, point_room, direction));
      Plane back = wall;
      back.normal = -wall.normal;
      back.waves.clear();
      behind = std::min(behind, distance_to(back, point_room, direction));
    }
    if (behind < front) return false;
    seen += front < std::numeric_limits<double>::infinity() ? 1 : 0;
  }
  return 2 * seen > kDirections;
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
