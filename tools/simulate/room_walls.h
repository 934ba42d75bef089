#pragma once

#include <vector>

#include "tools/common/random.h"
#include "tools/plan/wall.h"
#include "tools/simulate/scene.h"

namespace roomcal::tools {

/// Floor, four walls up to half a degree out of true, ceiling: unbounded planes of a convex room.
void build_box(const Vec3& size_m, Random& random, Scene& scene);

/// Rectangles as somebody drew them; `low` and `size` of the scene become the box around them.
/// @throws ToolError for fewer than three walls, or if nothing lies within them
void build_drawn_walls(const std::vector<Wall>& walls, Scene& scene);

/// Makes every wall ripple: waves of 0.8 to 3 m that together have this standard deviation.
void add_waves(double sigma_m, Random& random, Scene& scene);

/// How far a wall's surface is from its plane.
struct Waviness {
  double sigma_m = 0, max_m = 0;
};
Waviness waviness_of(const Plane& wall);

/// A random place in a room of bounded walls, at a height, and off all walls and bodies.
/// @throws ToolError if none is found.
Vec3 draw_free_place(const Scene& scene, double height_m, double off_m, Random& random);

}  // namespace roomcal::tools
