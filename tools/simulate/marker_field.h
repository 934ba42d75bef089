#pragma once

#include <memory>
#include <vector>

#include "runtime/camera/camera.h"
#include "tools/simulate/marker_truth.h"
#include "tools/simulate/paint.h"
#include "tools/simulate/raster.h"
#include "tools/simulate/scene.h"

namespace roomcal::tools {

/// Many markers of one apparent size and slant, each in a cell of its own: for figures about the detector.
struct FieldOptions {
  camera::Intrinsics lens;
  double diameter_px = 40;          ///< major axis of the outer circle's image
  double slant_rad = 0;             ///< between the normal and the ray to the marker's centre; azimuths are random
  double gradient = 0;              ///< change of the light over one diameter, as a share of its mean
  double gradient_azimuth_rad = 0;  ///< direction in the image in which it grows, from +x towards +y
  double paper_grey = 180;
  double ink_grey = 25;
  double pitch = 1.75;           ///< cell size in diameters; a sheet larger than its cell is cut by the next one
  Vec2 shift_px = Vec2::Zero();  ///< of every marker: to differentiate a picture by the place of its markers
  RingRadii ring_radii = kBestRings;
  bool empty = false;  ///< walls and no sheets, for timing
  uint64_t seed = 1;
};

/// One marker of a field, in the camera's frame, with the circle's radius as the unit of length.
struct FieldMarker {
  Vec3 centre_cam = Vec3::Zero();
  Vec3 axis_u_cam = Vec3::UnitX();
  Vec3 axis_v_cam = Vec3::UnitY();
  double sheet_angle_rad = 0;
  Vec2 centre_px = Vec2::Zero();  ///< truth
};

/// The field as a picture. Its light varies linearly across each marker and its surroundings, in the image, and falls
/// back to the mean towards the cell's border: a jump there would be a hard edge beside every small marker.
class MarkerField final : public Radiance {
 public:
  /// @throws ToolError if not one cell fits into the image.
  explicit MarkerField(const FieldOptions& options);

  const std::vector<FieldMarker>& markers() const { return markers_; }
  const camera::Camera& camera() const { return camera_; }
  const FieldOptions& options() const { return options_; }

  void sample(int x, int y, PixelSamples& samples) const override;

 private:
  FieldMarker draw_marker(const Vec2& cell_centre_px, uint64_t stream) const;
  /// Light relative to that at the marker's centre.
  double light_at(const FieldMarker& marker, const Vec2& px) const;
  /// A marker's sheet in its plane, lengths in radii.
  struct Sheet {
    Plane plane;
    PaintedDecal print;
  };
  /// Grey level without the light. @param footprint  on the sheet's plane; null where the ray misses it
  Paint paint_at(const Sheet& sheet, const Vec3& ray, const Mat22* footprint, double sample_px) const;

  FieldOptions options_;
  camera::Camera camera_;
  double cell_px_ = 0;
  Vec2 uphill_ = Vec2::UnitX();
  int columns_ = 0;
  int rows_ = 0;
  std::vector<FieldMarker> markers_;
  std::vector<Sheet> sheets_;
};

/// Image of a circle of radius `radius` (in the marker's own) about its centre.
CircleImage circle_image(const FieldMarker& marker, const camera::Camera& camera, double radius);

}  // namespace roomcal::tools
