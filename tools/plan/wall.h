#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "runtime/math/types.h"

namespace roomcal::tools {

/// A rectangle that sheets may be put on: point = corner + x right + y up, seen from inside the room.
struct Wall {
  std::string name;
  Vec3 corner_room = Vec3::Zero();  ///< lower left
  Vec3 right_room = Vec3::UnitX();
  Vec3 up_room = Vec3::UnitY();
  Vec2 size_m = Vec2::Zero();
  std::vector<Eigen::AlignedBox2d> keep_out_m;  ///< doors, windows, cupboards; the wall's own coordinates

  Vec3 normal_room() const { return right_room.cross(up_room); }
  Vec3 point_room(const Vec2& at_m) const { return corner_room + at_m.x() * right_room + at_m.y() * up_room; }
};

/// Floor and four walls of a box, CONVENTIONS.md's room frame: origin in a floor corner, z up.
/// @param text  "3x4x2.7": along x, along y, height, metres. @throws ToolError unless each is 1 to 50 m.
std::vector<Wall> box_walls(const std::string& text, bool with_ceiling);

/// Walls of a YAML:
///
///     walls:
///       - name: north
///         corner: [0, 4, 0]    # lower left, seen from inside, m
///         right: [1, 0, 0]
///         up: [0, 0, 1]        # optional on walls
///         size: [3, 2.7]
///         keep_out: [[0.5, 0, 1.4, 2.0]]   # left, bottom, right, top; optional
/// @throws ToolError naming the file, the line and what is wrong.
std::vector<Wall> read_walls(const std::string& name, const std::string& text);

}  // namespace roomcal::tools
