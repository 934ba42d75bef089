#pragma once

#include <vector>

#include "tools/simulate/scene.h"

namespace roomcal::tools {

/// A plane through `point` with the axes chosen for people: v up on walls, u x v = normal.
Plane make_plane(const std::string& name, const Vec3& point, const Vec3& normal, double albedo);

/// Corners of one wall of the room, in order: its own ends, or where it meets its neighbours. Cost: O(walls^3), for
/// files.
std::vector<Vec3> polygon_of(const Scene& scene, const Plane& wall);

/// An upright box.
Body make_box(const std::string& name, const Vec3& centre, const Vec3& half_size, double yaw_rad, double albedo);

/// Sets the ball around a body. @param corners  of it, whatever their order
void bound(Body& body, const std::vector<Vec3>& corners);

/// Corners of a body: where three of its faces meet. Cost: O(faces^4), for files.
std::vector<Vec3> corners_of(const Body& body);

/// Whether a point is within a room of bounded walls: no direction sees a wall from behind, and most see one.
bool in_free_space(const Scene& scene, const Vec3& point_room);

/// Lower bound of the distance from a point to a body; negative inside.
double clearance(const Body& body, const Vec3& point_room);

/// Whether two rectangles of paper overlap (separating axes).
bool overlap(const Decal& a, const Decal& b, double gap_m);

}  // namespace roomcal::tools
