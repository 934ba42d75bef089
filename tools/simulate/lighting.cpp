#include "tools/simulate/lighting.h"

#include <algorithm>
#include <cmath>

#include "tools/simulate/raster.h"
#include "tools/simulate/ray.h"

namespace roomcal::tools {

namespace {

constexpr double kSpacing_m = 0.01;
constexpr double kMargin_m = 0.05;  // the table reaches over the plane's ends, where walls lean outwards
constexpr int kPanelPoints = 4;     // along each side of a panel

double from_point_lamp(const Scene& scene, const Lamp& lamp, const Vec3& place, const Vec3& point_room,
                       const Vec3& normal_room) {
  const Vec3 to_lamp = place - point_room;
  const double r = to_lamp.norm();
  const double facing = normal_room.dot(to_lamp) / r;
  const double emission = lamp.all_around ? 1 : to_lamp.z() / r;
  if (facing <= 0 || emission <= 0) return 0;
  const Vec3 lifted = point_room + 1e-6 * normal_room;  // a face does not shadow itself
  if (is_hidden(scene, lifted, place)) return 0;
  constexpr double kNearest_m = 0.05;  // 1/r^2 ends at the lamp's own size
  return lamp.intensity * facing * emission / std::max(r * r, kNearest_m * kNearest_m);
}

double from_lamp(const Scene& scene, const Lamp& lamp, const Vec3& point_room, const Vec3& normal_room) {
  if (lamp.half_size.isZero()) return from_point_lamp(scene, lamp, lamp.centre, point_room, normal_room);
  double sum = 0;
  for (int i = 0; i < kPanelPoints; ++i) {
    for (int j = 0; j < kPanelPoints; ++j) {
      const Vec2 offset(2 * (i + 0.5) / kPanelPoints - 1, 2 * (j + 0.5) / kPanelPoints - 1);
      const Vec3 place = lamp.centre + Vec3(offset.x() * lamp.half_size.x(), offset.y() * lamp.half_size.y(), 0);
      sum += from_point_lamp(scene, lamp, place, point_room, normal_room);
    }
  }
  return sum / (kPanelPoints * kPanelPoints);
}

}  // namespace

double irradiance(const Scene& scene, const Vec3& point_room, const Vec3& normal_room) {
  double sum = scene.ambient;
  for (const Lamp& lamp : scene.lamps) sum += from_lamp(scene, lamp, point_room, normal_room);
  return scene.darkness ? scene.darkness->share_at(point_room) * sum : sum;
}

LightMap::LightMap(const Scene& scene, const Plane& plane)
    : columns_(static_cast<int>((plane.size.x() + 2 * kMargin_m) / kSpacing_m) + 2),
      rows_(static_cast<int>((plane.size.y() + 2 * kMargin_m) / kSpacing_m) + 2),
      values_(static_cast<std::size_t>(columns_ * rows_)) {
  parallel_for(rows_, [&](int row) {
    for (int column = 0; column < columns_; ++column) {
      const Vec2 q(column * kSpacing_m - kMargin_m, row * kSpacing_m - kMargin_m);
      cell(column, row) = static_cast<float>(irradiance(scene, plane.point(q), plane.normal));
    }
  });
}

double LightMap::at(const Vec2& q) const {
  const double x = std::clamp((q.x() + kMargin_m) / kSpacing_m, 0.0, columns_ - 1.001);
  const double y = std::clamp((q.y() + kMargin_m) / kSpacing_m, 0.0, rows_ - 1.001);
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const double low = std::lerp(cell(column, row), cell(column + 1, row), x - column);
  const double high = std::lerp(cell(column, row + 1), cell(column + 1, row + 1), x - column);
  return std::lerp(low, high, y - row);
}

}  // namespace roomcal::tools
