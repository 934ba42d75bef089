#pragma once

#include <vector>

#include "runtime/camera/camera.h"
#include "runtime/math/se3.h"
#include "tools/simulate/scene.h"

namespace roomcal::tools {

/// Area, centre and axes of the image of a circle: full axes (diameters) of the ellipse with the same second moments.
struct CircleImage {
  Vec2 centre_px = Vec2::Zero();
  double major_px = 0;
  double minor_px = 0;
  double angle_rad = 0;  ///< of the major axis, from +x towards +y
};

/// @param outline_px  points along the curve, in order
CircleImage measure_outline(const std::vector<Vec2>& outline_px);

/// What the truth file says of one marker in one picture.
struct MarkerTruth {
  int id = 0;
  Vec2 uv_px = Vec2::Zero();  ///< projection of the circle's centre
  CircleImage outer;
  double slant_rad = 0;  ///< between the normal and the ray to the camera
  double distance_m = 0;
  double visible = 0;  ///< share of the disc inside the image and not hidden
};

/// Markers of which anything is visible, by id.
std::vector<MarkerTruth> project_markers(const Scene& scene, const camera::Camera& camera, const SE3& T_room_cam);

/// The images of markers in the scene's mirrors, wall by wall.
std::vector<MarkerTruth> project_mirrored_markers(const Scene& scene, const camera::Camera& camera,
                                                  const SE3& T_room_cam);

}  // namespace roomcal::tools
