#pragma once

#include "runtime/base/status.h"
#include "runtime/camera/intrinsics.h"
#include "runtime/math/types.h"

namespace roomcal::camera {

/// Derivatives of project(); ask for the ones you need with a non-null pointer.
struct ProjectJacobians {
  Mat23 J_point;                                            ///< d px / d point_cam, px per metre
  Eigen::Matrix<double, 2, kIntrinsicsCount> J_intrinsics;  ///< d px / d (fx fy cx cy d0 d1 d2 d3)
};

/// One camera, ready to use: parameters and the limit of the field in which its distortion is one-to-one.
class Camera {
 public:
  Camera() = default;

  /// @return kInvalidArgument if a parameter is not finite, a focal length is not positive, the size is not
  ///         positive, or the distortion folds back near the axis already (field_limit.h).
  /// Cost: some thousand multiplications; done once.
  static Result<Camera> create(const Intrinsics& intrinsics);

  const Intrinsics& intrinsics() const { return intrinsics_; }

  /// px = projection of point_cam.
  ///
  /// @param point_cam  metres, x right, y down, z forward; its length does not matter.
  /// @param[out] px  untouched unless kOk. It may lie outside the image: the image is not the field.
  /// @param[out] jacobians  untouched unless kOk; may be null.
  /// @return kOutOfRange outside the valid field (behind a pinhole camera, where the distortion folds back, ten image
  ///         radii out, or a point without length); kInvalidArgument for a point that is not finite.
  /// Cost: constant, no iteration.
  Status project(const Vec3& point_cam, Vec2& px, ProjectJacobians* jacobians = nullptr) const;

  /// Unit vector that projects to px; project(unproject(px)) = px to 1e-9 px over the whole valid field.
  ///
  /// @param[out] bearing_cam  untouched unless kOk.
  /// @param[out] J_px  d bearing / d px (3x2), tangent to the sphere; may be null.
  /// @return kOutOfRange where no ray of the valid field projects to px; kInvalidArgument for a px that is not finite.
  /// Cost: a safeguarded Newton iteration, 4 to 6 rounds on a lens, bounded for any parameters.
  Status unproject(const Vec2& px, Vec3& bearing_cam, Mat32* J_px = nullptr) const;

  /// The valid field: the widest angle from the optical axis up to which the model is one-to-one, rad.
  double max_angle_rad() const { return max_angle_rad_; }

 private:
  Status project_radtan(const Vec3& point_cam, Vec2& px, ProjectJacobians* jacobians) const;
  Status project_fisheye(const Vec3& point_cam, Vec2& px, ProjectJacobians* jacobians) const;
  Status unproject_radtan(const Vec2& m_d, Vec3& bearing_cam, Mat32* J_m) const;
  Status unproject_fisheye(const Vec2& m_d, Vec3& bearing_cam, Mat32* J_m) const;
  Vec2 to_pixels(const Vec2& m_d) const {
    return {intrinsics_.fx_px * m_d.x() + intrinsics_.cx_px, intrinsics_.fy_px * m_d.y() + intrinsics_.cy_px};
  }

  Intrinsics intrinsics_;
  double max_angle_rad_ = 0;
  double max_tan_ = 0;  ///< pinhole only: tan(max_angle_rad_)
};

}  // namespace roomcal::camera
