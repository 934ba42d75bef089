#include "tools/simulate/marker_field.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "tools/common/error.h"
#include "tools/simulate/paint.h"
#include "tools/simulate/random_stream.h"
#include "tools/simulate/ray.h"

namespace roomcal::tools {

namespace {

constexpr double kEdgeReach_px = 1.0;
constexpr double kWallAlbedo = 0.42;
constexpr double kLinearReach = 0.65;  // diameters from the centre; the blurred outer edge lies within

Plane plane_of(const FieldMarker& marker) {
  Plane plane;
  plane.origin = marker.centre_cam;
  plane.axis_u = marker.axis_u_cam;
  plane.axis_v = marker.axis_v_cam;
  plane.normal = marker.axis_u_cam.cross(marker.axis_v_cam);
  return plane;
}

Decal decal_of(const FieldMarker& marker, const RingRadii& ring_radii) {
  Decal sheet;
  sheet.angle_rad = marker.sheet_angle_rad;
  sheet.half_size = Vec2(kSheetWidth_m, kSheetHeight_m) / (2 * kMarkerRadius_m);
  sheet.radius_m = 1;  // lengths are radii
  sheet.ring_radii = ring_radii;
  return sheet;
}

}  // namespace

CircleImage circle_image(const FieldMarker& marker, const camera::Camera& camera, double radius) {
  constexpr int kPoints = 180;
  std::vector<Vec2> outline;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2 * kPi * i / kPoints;
    const Vec3 point =
        marker.centre_cam + radius * (std::cos(angle) * marker.axis_u_cam + std::sin(angle) * marker.axis_v_cam);
    Vec2 px;
    require(camera.project(point, px), "marker of the field");
    outline.push_back(px);
  }
  return measure_outline(outline);
}

MarkerField::MarkerField(const FieldOptions& options) : options_(options) {
  auto made = camera::Camera::create(options.lens);
  require(made.status(), "lens of the marker field");
  camera_ = made.value();
  cell_px_ = options.pitch * options.diameter_px + 6;
  uphill_ = Vec2(std::cos(options.gradient_azimuth_rad), std::sin(options.gradient_azimuth_rad));
  columns_ = static_cast<int>(options.lens.width_px / cell_px_);
  rows_ = static_cast<int>(options.lens.height_px / cell_px_);
  if (columns_ < 1 || rows_ < 1) throw ToolError("marker field: the image is smaller than one marker; enlarge it");
  for (int i = 0; i < columns_ * rows_; ++i) {
    const Vec2 cell_centre((i % columns_ + 0.5) * cell_px_ - 0.5, (i / columns_ + 0.5) * cell_px_ - 0.5);
    markers_.push_back(draw_marker(cell_centre, static_cast<uint64_t>(i)));
    sheets_.push_back({plane_of(markers_.back()), PaintedDecal(decal_of(markers_.back(), options.ring_radii))});
  }
}

FieldMarker MarkerField::draw_marker(const Vec2& cell_centre_px, uint64_t stream) const {
  Random random = random_stream(options_.seed, stream);
  FieldMarker marker;
  marker.centre_px = cell_centre_px + Vec2(random.uniform(-1, 1), random.uniform(-1, 1)) + options_.shift_px;
  Vec3 bearing;
  require(camera_.unproject(marker.centre_px, bearing), "marker of the field");

  const double azimuth = random.uniform(-kPi, kPi);
  const Vec3 any = bearing.unitOrthogonal();
  const Vec3 tilt_axis = std::cos(azimuth) * any + std::sin(azimuth) * bearing.cross(any);
  marker.axis_u_cam = tilt_axis;
  marker.axis_v_cam = so3_exp(options_.slant_rad * tilt_axis) * bearing.cross(tilt_axis);
  if (marker.axis_u_cam.cross(marker.axis_v_cam).dot(bearing) > 0) marker.axis_v_cam *= -1;  // the normal faces us
  marker.sheet_angle_rad = random.uniform(-kPi, kPi);

  double distance = 2 * options_.lens.fx_px / options_.diameter_px;
  for (int round = 0; round < 4; ++round) {  // the image is nearly inverse to the distance
    marker.centre_cam = distance * bearing;
    distance *= circle_image(marker, camera_, 1).major_px / options_.diameter_px;
  }
  marker.centre_cam = distance * bearing;
  return marker;
}

double MarkerField::light_at(const FieldMarker& marker, const Vec2& px) const {
  const double t = uphill_.dot(px - marker.centre_px) / options_.diameter_px;
  const double to_border = cell_px_ / (2 * options_.diameter_px) - std::abs(t);
  const double fall = kLinearReach / (cell_px_ / (2 * options_.diameter_px) - kLinearReach);
  return 1 + options_.gradient * std::copysign(std::min(std::abs(t), fall * std::max(0.0, to_border)), t);
}

Paint MarkerField::paint_at(const Sheet& sheet, const Vec3& ray, const Mat22* footprint, double sample_px) const {
  const Paint wall{kWallAlbedo, 1e9};
  if (footprint == nullptr) return wall;
  const double distance = sheet.plane.normal.dot(sheet.plane.origin) / sheet.plane.normal.dot(ray);
  return sheet.print.over(wall, sheet.plane.coordinates(distance * ray), *footprint, sample_px);
}

void MarkerField::sample(int x, int y, PixelSamples& samples) const {
  samples.fill(0);
  PixelRays rays;
  if (!camera_.unproject(Vec2(x, y), rays.direction, &rays.J_px).ok()) return;
  const int column = std::clamp(static_cast<int>((x + 0.5) / cell_px_), 0, columns_ - 1);
  const int row = std::clamp(static_cast<int>((y + 0.5) / cell_px_), 0, rows_ - 1);
  const auto index = static_cast<std::size_t>(row * columns_ + column);
  const Sheet& sheet = sheets_[index];

  const double speed = sheet.plane.normal.dot(rays.direction);
  const bool meets = speed < -1e-3 && !options_.empty;
  Mat22 footprint;  // one for all parts: it changes by a part in a thousand across a pixel
  if (meets)
    footprint = footprint_on(sheet.plane, sheet.plane.normal, rays, sheet.plane.normal.dot(sheet.plane.origin) / speed);
  const Mat22* on_sheet = meets ? &footprint : nullptr;

  const Paint whole = paint_at(sheet, rays.direction, on_sheet, 1);
  const bool flat = whole.edge_px > kEdgeReach_px;
  const double slope = (options_.paper_grey - options_.ink_grey) / (kPaperAlbedo - kInkAlbedo);
  for (int j = 0; j < kSub; ++j) {
    for (int i = 0; i < kSub; ++i) {
      const Vec2 offset(sub_offset_px(i), sub_offset_px(j));
      const Paint paint = flat ? whole : paint_at(sheet, rays.at(offset.x(), offset.y()), on_sheet, 1.0 / kSub);
      const double grey = options_.ink_grey + slope * (paint.albedo - kInkAlbedo);
      samples[static_cast<std::size_t>(j * kSub + i)] =
          static_cast<float>(grey * light_at(markers_[index], Vec2(x, y) + offset));
    }
  }
}

}  // namespace roomcal::tools
