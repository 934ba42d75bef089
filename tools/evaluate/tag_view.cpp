#include "tools/evaluate/tag_view.h"

#include <algorithm>
#include <cmath>

namespace roomcal::tools {

namespace {

bool is_sheet(const Decal& decal) { return decal.print == Print::kRings; }

Mat22 R_plane_sheet(const Decal& sheet) {
  Mat22 R;
  R << std::cos(sheet.angle_rad), -std::sin(sheet.angle_rad), std::sin(sheet.angle_rad), std::cos(sheet.angle_rad);
  return R;
}

/// Length that [low, high] and the cell [index, index + 1] have in common.
double overlap(double low, double high, int index) {
  return std::max(0.0, std::min(high, index + 1.0) - std::max(low, static_cast<double>(index)));
}

/// Share of ink in a rectangle about `at`, both in cells.
double ink_of(const TagCells& cells, const Vec2& at, const Vec2& size) {
  const Vec2 low = at - size / 2, high = at + size / 2;
  double ink = 0;
  for (int row = std::max(0, static_cast<int>(low.y())); row < cells.across && row < high.y(); ++row)
    for (int column = std::max(0, static_cast<int>(low.x())); column < cells.across && column < high.x(); ++column)
      if (cells.ink[static_cast<std::size_t>(row * cells.across + column)])
        ink += overlap(low.x(), high.x(), column) * overlap(low.y(), high.y(), row);
  return ink / size.prod();
}

/// The sheet whose square lies nearest: sheets are close enough for a circle around one to reach into another's square.
const Decal* sheet_at(const Plane& plane, const Vec2& q) {
  constexpr double kReach = 1.2, kDiagonal = 1.7;  // of half a side: a pixel beyond the edge
  const Decal* nearest = nullptr;
  double nearest_sides = kReach;
  for (const Decal& decal : plane.decals) {
    if (!is_sheet(decal) || (q - decal.centre).norm() > kDiagonal * decal.radius_m) continue;
    const Vec2 local = R_plane_sheet(decal).transpose() * (q - decal.centre);
    const double sides = local.lpNorm<Eigen::Infinity>() / decal.radius_m;
    if (sides >= nearest_sides) continue;
    nearest_sides = sides;
    nearest = &decal;
  }
  return nearest;
}

}  // namespace

Scene with_blank_sheets(Scene scene) {
  for (Plane& wall : scene.walls)
    for (Decal& decal : wall.decals)
      if (is_sheet(decal)) decal.radius_m = 0;
  return scene;
}

std::array<Vec3, 4> tag_corners_room(const Plane& plane, const Decal& sheet) {
  std::array<Vec3, 4> corners;
  for (std::size_t k = 0; k < corners.size(); ++k)
    corners[k] = plane.point(sheet.centre +
                             R_plane_sheet(sheet) * (sheet.radius_m * Vec2(kTagCorners[k][0], kTagCorners[k][1])));
  return corners;
}

TagView::TagView(const LitScene& blank, const Scene& rings, const camera::Camera& camera, const SE3& T_room_cam)
    : rings_(rings), camera_(camera), T_room_cam_(T_room_cam), blank_(blank, camera, T_room_cam) {
  for (const SceneMarker& marker : markers_of(rings)) cells_[marker.id] = tag_cells(marker.id);
}

void TagView::sample(int x, int y, PixelSamples& samples) const {
  blank_.sample(x, y, samples);
  Vec3 bearing_cam;
  Mat32 J_px;
  if (!camera_.unproject(Vec2(x, y), bearing_cam, &J_px).ok()) return;
  const PixelRays rays{T_room_cam_.R * bearing_cam, T_room_cam_.R * J_px};
  const Hit hit = cast_flat(rings_, T_room_cam_.t, rays.direction);
  if (hit.plane == nullptr) return;
  const auto place = [&](const Vec3& ray) {
    return hit.plane->coordinates(T_room_cam_.t + distance_to(*hit.plane, T_room_cam_.t, ray) * ray);
  };
  const Decal* sheet = sheet_at(*hit.plane, place(rays.direction));
  if (sheet == nullptr) return;
  const TagCells& cells = *cells_.at(sheet->marker_id);
  const Mat22 R_sheet_plane = R_plane_sheet(*sheet).transpose();
  const double cells_per_m = cells.across / (2 * sheet->radius_m);
  const Mat22 footprint =
      R_sheet_plane * footprint_on(*hit.plane, hit.plane->normal, rays, hit.distance) * (cells_per_m / kSub);
  const Vec2 size(footprint.row(0).norm(), footprint.row(1).norm());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec3 ray = rays.at(sub_offset_px(static_cast<int>(i % kSub)), sub_offset_px(static_cast<int>(i / kSub)));
    const Vec2 local = R_sheet_plane * (place(ray) - sheet->centre);
    const Vec2 at = Vec2(local.x() + sheet->radius_m, sheet->radius_m - local.y()) * cells_per_m;  // row 0 is on top
    samples[i] *= static_cast<float>(std::lerp(1.0, kInkAlbedo / kPaperAlbedo, ink_of(cells, at, size)));
  }
}

}  // namespace roomcal::tools
