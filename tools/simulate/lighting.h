#pragma once

#include <vector>

#include "tools/simulate/scene.h"

namespace roomcal::tools {

/// Irradiance at a point of a surface: every lamp by Lambert's law and 1/r^2, panels as a grid of points, with the
/// shadows of the bodies, and the ambient light.
double irradiance(const Scene& scene, const Vec3& point_room, const Vec3& normal_room);

/// Irradiance over a plane, tabulated every centimetre and interpolated: a shadow of a point lamp is then 1 cm soft.
class LightMap {
 public:
  /// Cost: about 0.2 us per cell and lamp point.
  LightMap(const Scene& scene, const Plane& plane);

  double at(const Vec2& q) const;

 private:
  float& cell(int column, int row) { return values_[static_cast<std::size_t>(row * columns_ + column)]; }
  double cell(int column, int row) const { return values_[static_cast<std::size_t>(row * columns_ + column)]; }

  int columns_ = 0;
  int rows_ = 0;
  std::vector<float> values_;
};

}  // namespace roomcal::tools
