#pragma once

#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/camera/camera.h"
#include "runtime/math/types.h"
#include "runtime/pose/locate_camera.h"

namespace roomcal::pose {

/// An observation as a line of sight with its uncertainty on the unit sphere: no camera model from here on.
struct Sight {
  Vec3 bearing_cam = Vec3::UnitZ();
  Mat32 tangent = Mat32::Zero();         ///< orthonormal columns, normal to the bearing
  Mat22 cov_rad2 = Mat22::Identity();    ///< of the bearing in the tangent plane
  Mat22 rad_per_px = Mat22::Identity();  ///< tangent-plane movement by pixel movement
  double sigma_rad = 0;                  ///< root of the larger variance
  double gate_rad = 0;                   ///< LocateOptions::gate_px on the sphere
  double semi_major_rad = 0;             ///< of the outer circle's image; 0: no ellipse
  double cos_slant = 0;                  ///< minor over major axis on the sphere
  uint16_t observation = 0;
};

/// All sights of one image, by ascending bearing_cam.x: the nearest one to a direction is found by bisection.
struct SightSet {
  std::span<Sight> sights;
  Vec3 axis_cam = Vec3::UnitZ();  ///< of a cone that holds every sight
  double cos_field = 1;           ///< of its half angle
  double field_sr = 0;            ///< its solid angle
  double max_gate_rad = 0;
  bool has_ellipses = false;  ///< most sights have one
};

std::size_t sights_bytes(std::size_t observations);

/// @param[out] set  in the arena. Observations outside the camera's valid field are left out.
/// @return kInvalidArgument (not finite, or a covariance that is not positive), kOutOfMemory.
Status make_sights(const camera::Camera& camera, std::span<const Observation> observations, double gate_px,
                   Arena& arena, SightSet& set);

/// Number of the sight nearest to a direction, within gate_rad; -1 if there is none.
int nearest_sight(const SightSet& set, const Vec3& direction_cam, double gate_rad);

}  // namespace roomcal::pose
