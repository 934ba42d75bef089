#include "runtime/camera/camera.h"

#include <cmath>

#include "runtime/camera/field_limit.h"
#include "runtime/camera/kannala_brandt.h"
#include "runtime/camera/pinhole_radtan.h"

namespace roomcal::camera {

namespace {

// Beyond these a number is mistyped; memory plans grow with the size of the image.
constexpr double kMaxFocal_px = 1e7;
constexpr int kMaxSide_px = 65535;

// Squared lengths outside this range are no metres of any room, and their reciprocals would overflow.
constexpr double kMinLength2 = 1e-200, kMaxLength2 = 1e200;

bool all_finite(const Intrinsics& intrinsics) {
  bool finite = std::isfinite(intrinsics.fx_px) && std::isfinite(intrinsics.fy_px) && std::isfinite(intrinsics.cx_px) &&
                std::isfinite(intrinsics.cy_px);
  for (const double d : intrinsics.distortion) finite = finite && std::isfinite(d);
  return finite;
}

// The columns that both models share; m_d is in the normalized plane, J_m its derivatives.
void fill_jacobians(const Intrinsics& intrinsics, const Vec2& m_d, const Mat23& J_m_point,
                    const Eigen::Matrix<double, 2, kDistortionCount>& J_m_distortion, ProjectJacobians& out) {
  const Eigen::DiagonalMatrix<double, 2> focal_px(intrinsics.fx_px, intrinsics.fy_px);
  out.J_point = focal_px * J_m_point;
  out.J_intrinsics.leftCols<4>() << m_d.x(), 0, 1, 0, 0, m_d.y(), 0, 1;
  out.J_intrinsics.rightCols<kDistortionCount>() = focal_px * J_m_distortion;
}

}  // namespace

Result<Camera> Camera::create(const Intrinsics& intrinsics) {
  if (!all_finite(intrinsics)) return Status{StatusCode::kInvalidArgument, "intrinsics are not finite numbers"};
  if (!(intrinsics.fx_px > 0 && intrinsics.fy_px > 0))
    return Status{StatusCode::kInvalidArgument, "focal length is not positive: check fx, fy (px)"};
  if (intrinsics.width_px <= 0 || intrinsics.height_px <= 0)
    return Status{StatusCode::kInvalidArgument, "image size is not positive: check the resolution"};

  if (intrinsics.fx_px > kMaxFocal_px || intrinsics.fy_px > kMaxFocal_px)
    return Status{StatusCode::kInvalidArgument, "focal length is beyond 1e7 px: check fx, fy (px)"};
  if (intrinsics.width_px > kMaxSide_px || intrinsics.height_px > kMaxSide_px)
    return Status{StatusCode::kInvalidArgument, "image size is beyond 65535 px a side: check the resolution"};

  Camera camera;
  camera.intrinsics_ = intrinsics;
  const double corner = corner_radius(intrinsics);
  double edge = 0;  // of the field, in the distorted plane
  if (intrinsics.model == Model::kPinholeRadtan) {
    const PinholeRadtan lens = PinholeRadtan::from(intrinsics);
    camera.max_tan_ = lens.max_radius(kMaxCornerRadii * corner);
    camera.max_angle_rad_ = std::atan(camera.max_tan_);
    edge = lens.distort({camera.max_tan_, 0}).norm();
  } else {
    const KannalaBrandt lens = KannalaBrandt::from(intrinsics);
    camera.max_angle_rad_ = lens.max_angle_rad(kMaxCornerRadii * corner);
    edge = lens.radius(camera.max_angle_rad_).value;
  }
  if (!(edge >= kMinCornerRadii * corner))
    return Status{StatusCode::kInvalidArgument,
                  "distortion folds back close to the optical axis: check the coefficients and their order"};
  return camera;
}

Status Camera::project(const Vec3& point_cam, Vec2& px, ProjectJacobians* jacobians) const {
  const double length2 = point_cam.squaredNorm();
  if (!(length2 > kMinLength2 && length2 < kMaxLength2)) {
    if (!point_cam.allFinite()) return {StatusCode::kInvalidArgument, "point to project is not finite"};
    return {StatusCode::kOutOfRange, "point to project has no usable length"};
  }
  return intrinsics_.model == Model::kPinholeRadtan ? project_radtan(point_cam, px, jacobians)
                                                    : project_fisheye(point_cam, px, jacobians);
}

Status Camera::project_radtan(const Vec3& point_cam, Vec2& px, ProjectJacobians* jacobians) const {
  const double z = point_cam.z();
  const Vec2 xy = point_cam.head<2>();
  if (!(z > 0 && xy.squaredNorm() <= max_tan_ * max_tan_ * z * z))
    return {StatusCode::kOutOfRange, "point lies outside the field of the camera model"};
  const PinholeRadtan lens = PinholeRadtan::from(intrinsics_);
  const Vec2 m = xy / z;
  if (jacobians == nullptr) {
    px = to_pixels(lens.distort(m));
    return ok_status();
  }
  Mat22 D;
  const Vec2 m_d = lens.distort(m, &D);
  Mat23 J_m;
  J_m << D / z, -(D * m) / z;
  fill_jacobians(intrinsics_, m_d, J_m, PinholeRadtan::parameter_jacobian(m), *jacobians);
  px = to_pixels(m_d);
  return ok_status();
}

Status Camera::project_fisheye(const Vec3& point_cam, Vec2& px, ProjectJacobians* jacobians) const {
  const double z = point_cam.z();
  const Vec2 xy = point_cam.head<2>();
  const double rho = xy.norm();
  const double theta_rad = std::atan2(rho, z);
  if (!(theta_rad <= max_angle_rad_))
    return {StatusCode::kOutOfRange, "point lies outside the field of the camera model"};
  const ValueAndSlope r = KannalaBrandt::from(intrinsics_).radius(theta_rad);
  const Vec2 e = rho > 0 ? Vec2(xy / rho) : Vec2(1, 0);
  const Vec2 m_d = r.value * e;
  px = to_pixels(m_d);
  if (jacobians == nullptr) return ok_status();

  // Along the radius m changes with theta, across it by turning: no difference of near-equal numbers at the axis.
  const double length2 = point_cam.squaredNorm();
  const double along = r.slope * z / length2, across = rho > 0 ? r.value / rho : 1 / z;
  Mat23 J_m;
  J_m.leftCols<2>() = (along - across) * e * e.transpose();
  J_m(0, 0) += across;
  J_m(1, 1) += across;
  J_m.col(2) = -(r.slope * rho / length2) * e;
  Eigen::Matrix<double, 2, kDistortionCount> J_distortion;
  double power = theta_rad * theta_rad * theta_rad;
  for (int i = 0; i < kDistortionCount; ++i, power *= theta_rad * theta_rad) J_distortion.col(i) = power * e;
  fill_jacobians(intrinsics_, m_d, J_m, J_distortion, *jacobians);
  return ok_status();
}

Status Camera::unproject(const Vec2& px, Vec3& bearing_cam, Mat32* J_px) const {
  if (!px.allFinite()) return {StatusCode::kInvalidArgument, "pixel to unproject is not finite"};
  const Vec2 m_d((px.x() - intrinsics_.cx_px) / intrinsics_.fx_px, (px.y() - intrinsics_.cy_px) / intrinsics_.fy_px);
  ROOMCAL_TRY(intrinsics_.model == Model::kPinholeRadtan ? unproject_radtan(m_d, bearing_cam, J_px)
                                                         : unproject_fisheye(m_d, bearing_cam, J_px));
  if (J_px != nullptr) {
    J_px->col(0) /= intrinsics_.fx_px;
    J_px->col(1) /= intrinsics_.fy_px;
  }
  return ok_status();
}

Status Camera::unproject_radtan(const Vec2& m_d, Vec3& bearing_cam, Mat32* J_m) const {
  const PinholeRadtan lens = PinholeRadtan::from(intrinsics_);
  Vec2 m;
  if (!lens.undistort(m_d, max_tan_, m))
    return {StatusCode::kOutOfRange, "no ray of the camera model's field projects to this pixel"};
  // One part in 1e14 inside the edge, so that project() takes the bearing back.
  const double edge = max_tan_ * (1 - 1e-14);
  if (m.norm() > edge) m *= edge / m.norm();
  const double length = std::sqrt(1 + m.squaredNorm());
  const Vec3 bearing(m.x() / length, m.y() / length, 1 / length);
  if (J_m != nullptr) {
    Mat22 D;
    [[maybe_unused]] const Vec2 again = lens.distort(m, &D);
    const double det = D(0, 0) * D(1, 1) - D(0, 1) * D(1, 0);
    Mat22 D_inv;
    D_inv << D(1, 1) / det, -D(0, 1) / det, -D(1, 0) / det, D(0, 0) / det;
    const Mat33 tangent = (Mat33::Identity() - bearing * bearing.transpose()) / length;
    *J_m = tangent.leftCols<2>() * D_inv;
  }
  bearing_cam = bearing;
  return ok_status();
}

Status Camera::unproject_fisheye(const Vec2& m_d, Vec3& bearing_cam, Mat32* J_m) const {
  const KannalaBrandt lens = KannalaBrandt::from(intrinsics_);
  const double r_d = m_d.norm();
  // One part in 1e14 inside the edge, so that project() takes the bearing back.
  const double theta_rad = std::fmin(lens.angle_rad(r_d, max_angle_rad_), max_angle_rad_ * (1 - 1e-14));
  if (!(theta_rad >= 0)) return {StatusCode::kOutOfRange, "no ray of the camera model's field projects to this pixel"};
  const Vec2 e = r_d > 0 ? Vec2(m_d / r_d) : Vec2(1, 0);
  const double s = std::sin(theta_rad), c = std::cos(theta_rad);
  bearing_cam << s * e, c;
  if (J_m != nullptr) {
    const double across = r_d > 0 ? s / r_d : 1;
    const Vec2 n(-e.y(), e.x());
    *J_m = Vec3(c * e.x(), c * e.y(), -s) * e.transpose() / lens.radius(theta_rad).slope;
    J_m->topRows<2>() += across * n * n.transpose();
  }
  return ok_status();
}

}  // namespace roomcal::camera
