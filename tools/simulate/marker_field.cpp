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

Plane plane_of(const FieldMarker& marker) {
  Plane plane;
  plane.origin = marker.centre_cam;
  plane.axis_u = marker.axis_u_cam;
  plane.axis_v = marker.axis_v_cam;
  plane.normal = marker.axis_u_cam.cross(marker.axis_v_cam);
  return plane;
}

Decal sheet_of(const FieldMarker& marker) {
  Decal sheet;
  sheet.angle_rad = marker.sheet_angle_rad;
  sheet.half_size = Vec2(kSheetWidth_m, kSheetHeight_m) / (2 * kMarkerRadius_m);
  sheet.radius_m = 1;  // lengths are radii
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
  columns_ = static_cast<int>(options.lens.width_px / cell_px_);
  rows_ = static_cast<int>(options.lens.height_px / cell_px_);
  if (columns_ < 1 || rows_ < 1) throw ToolError("marker field: the image is smaller than one marker; enlarge it");
  for (int i = 0; i < columns_ * rows_; ++i) {
    const Vec2 cell_centre((i % columns_ + 0.5) * cell_px_ - 0.5, (i / columns_ + 0.5) * cell_px_ - 0.5);
    markers_.push_back(draw_marker(cell_centre, static_cast<uint64_t>(i)));
  }
}

FieldMarker MarkerField::draw_marker(const Vec2& cell_centre_px, uint64_t stream) const {
  Random random = random_stream(options_.seed, stream);
  FieldMarker marker;
  marker.centre_px = cell_centre_px + Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
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
  const Vec2 uphill(std::cos(options_.gradient_azimuth_rad), std::sin(options_.gradient_azimuth_rad));
  return 1 + options_.gradient * (px - marker.centre_px).dot(uphill) / options_.diameter_px;
}

double MarkerField::shade(const FieldMarker& marker, const Vec3& ray, const Mat32& J_px, const Vec2& px,
                          double sample_px, double& edge_px) const {
  edge_px = 1e9;
  Paint paint{kWallAlbedo, 1e9};
  const Plane plane = plane_of(marker);
  const double speed = plane.normal.dot(ray);
  if (speed < 0 && !options_.empty) {
    const double distance = plane.normal.dot(marker.centre_cam) / speed;
    const Vec2 q = plane.coordinates(distance * ray);
    paint = paint_decal(sheet_of(marker), q, footprint_on(plane, {ray, J_px}, distance), sample_px, paint);
  }
  edge_px = paint.edge_px;
  const double slope = (options_.paper_grey - options_.ink_grey) / (kPaperAlbedo - kInkAlbedo);
  return light_at(marker, px) * (options_.ink_grey + slope * (paint.albedo - kInkAlbedo));
}

void MarkerField::sample(int x, int y, PixelSamples& samples) const {
  samples.fill(0);
  PixelRays rays;
  if (!camera_.unproject(Vec2(x, y), rays.direction, &rays.J_px).ok()) return;
  const int column = std::clamp(static_cast<int>((x + 0.5) / cell_px_), 0, columns_ - 1);
  const int row = std::clamp(static_cast<int>((y + 0.5) / cell_px_), 0, rows_ - 1);
  const FieldMarker& marker = markers_[static_cast<std::size_t>(row * columns_ + column)];
  double edge_px = 0;
  const double value = shade(marker, rays.direction, rays.J_px, Vec2(x, y), 1, edge_px);
  const bool flat = edge_px > kEdgeReach_px;
  const double light = light_at(marker, Vec2(x, y));
  for (int j = 0; j < kSub; ++j) {
    for (int i = 0; i < kSub; ++i) {
      const Vec2 offset(sub_offset_px(i), sub_offset_px(j));
      const Vec2 px = Vec2(x, y) + offset;
      samples[static_cast<std::size_t>(j * kSub + i)] =
          static_cast<float>(flat ? value * light_at(marker, px) / light
                                  : shade(marker, rays.at(offset.x(), offset.y()), rays.J_px, px, 1.0 / kSub, edge_px));
    }
  }
}

}  // namespace roomcal::tools
