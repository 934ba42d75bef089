#include "tools/bake/marker_shape.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

namespace roomcal::tools {

namespace {

constexpr int kSamples = 12;
constexpr double kSigma_px = 0.3;  // of an ellipse's contour point; sets the turn-over of the loss

/// A contour point as a ray in the room, with the scale that turns metres at the marker into pixels.
struct ContourRay {
  Vec3 origin_room, direction_room;
  double px_per_m = 0;
};

Vec2 contour_point(const marker::Ellipse& e, double phase_rad) {
  const double x = 0.5 * e.major_px * std::cos(phase_rad), y = 0.5 * e.minor_px * std::sin(phase_rad);
  const double c = std::cos(e.angle_rad), s = std::sin(e.angle_rad);
  return e.centre_px + Vec2(c * x - s * y, s * x + c * y);
}

class ShapeFit {
 public:
  ShapeFit(const Survey& survey, const Reconstruction& map, const std::vector<PointSight>& sights, const Vec3& p_room)
      : p_room_(p_room) {
    for (const PointSight& sight : sights) {
      const Sighting& seen = survey.views[sight.view].seen[sight.side][sight.sighting];
      if (seen.ellipse) add_ellipse(map, sight, *seen.ellipse);
    }
  }

  std::size_t ellipses() const { return ellipses_; }

  std::optional<MarkerShape> run(const Vec3& normal_start_room) {
    normal_ = normal_start_room.normalized();
    face_cameras();
    radius_m_ = mean_radius();
    Mat33 information;
    for (int round = 0; round < 20; ++round) {
      Vec3 gradient;
      if (!accumulate(information, gradient)) return std::nullopt;
      const Vec3 step = -(information + 1e-9 * information.trace() * Mat33::Identity()).ldlt().solve(gradient);
      if (!step.allFinite()) return std::nullopt;
      // A turn of more than half a radian per round leaves the linear range.
      const double shrink = std::min(1.0, 0.5 / std::max(1e-9, step.head<2>().norm()));
      normal_ = (normal_ + shrink * (step[0] * u() + step[1] * v())).normalized();
      radius_m_ += shrink * step[2];
      if (step.norm() < 1e-9) break;
    }
    return judge(information);
  }

 private:
  void add_ellipse(const Reconstruction& map, const PointSight& sight, const marker::Ellipse& ellipse) {
    const SE3& T_room_left = map.views[sight.view].T_room_left;
    const SE3 T_room_cam = sight.side == kLeft ? T_room_left : T_room_left * map.rig.T_right_left.inverse();
    const camera::Camera& camera = map.rig.cameras[sight.side];
    for (int i = 0; i < kSamples; ++i) {
      Vec3 bearing;
      if (!camera.unproject(contour_point(ellipse, 2 * kPi * i / kSamples), bearing).ok()) return;
      rays_.push_back(
          {T_room_cam.t, T_room_cam.R * bearing, camera.intrinsics().fx_px / (p_room_ - T_room_cam.t).norm()});
    }
    to_cameras_ += (T_room_cam.t - p_room_).normalized();
    ++ellipses_;
  }

  void face_cameras() {
    if (normal_.dot(to_cameras_) < 0) normal_ = -normal_;
  }

  Vec3 u() const { return normal_.unitOrthogonal(); }
  Vec3 v() const { return normal_.cross(u()); }

  /// Where a ray meets the plane, seen from the centre; false for a ray along the plane.
  bool arm_of(const ContourRay& ray, Vec3& arm, double& slope) const {
    slope = normal_.dot(ray.direction_room);
    if (std::abs(slope) < 0.02) return false;
    const double range_m = normal_.dot(p_room_ - ray.origin_room) / slope;
    arm = ray.origin_room + range_m * ray.direction_room - p_room_;
    return range_m > 0;
  }

  double mean_radius() const {
    double sum = 0;
    int count = 0;
    for (const ContourRay& ray : rays_) {
      Vec3 arm;
      double slope = 0;
      if (!arm_of(ray, arm, slope)) continue;
      sum += arm.norm();
      ++count;
    }
    return count > 0 ? sum / count : 0;
  }

  /// In (turn about u, turn about v, radius). With the plane n . (x - p) = 0 and x on the ray, turning n by delta moves
  /// x along the ray by -(arm . delta) / slope.
  bool accumulate(Mat33& information, Vec3& gradient) {
    information.setZero();
    gradient.setZero();
    sum2_px2_ = weights_ = 0;
    const Vec3 along_u = u(), along_v = v();
    for (const ContourRay& ray : rays_) {
      Vec3 arm;
      double slope = 0;
      if (!arm_of(ray, arm, slope)) continue;
      const double length = arm.norm();
      if (length < 1e-6) continue;
      // A metre on a slanted plane is fewer pixels.
      const double scale = ray.px_per_m * std::max(0.2, std::abs(slope));
      const double residual = (length - radius_m_) * scale;
      const double per_turn = -arm.dot(ray.direction_room) / (length * slope);
      const Vec3 J = scale * Vec3(per_turn * arm.dot(along_u), per_turn * arm.dot(along_v), -1);
      const double weight = 1 / (1 + residual * residual / (4 * kSigma_px * kSigma_px));
      information += weight * J * J.transpose();
      gradient += weight * J * residual;
      sum2_px2_ += weight * residual * residual;
      weights_ += weight;
    }
    return weights_ > kSamples;
  }

  std::optional<MarkerShape> judge(const Mat33& information) {
    face_cameras();
    constexpr double kMaxResidual_px = 2;
    const double variance_px2 = sum2_px2_ / weights_;
    if (variance_px2 > kMaxResidual_px * kMaxResidual_px || !(radius_m_ > 0)) return std::nullopt;
    // Samples of one ellipse share its errors: only five of them are independent.
    const Mat33 cov = variance_px2 * (kSamples / 5.0) * information.inverse();
    return MarkerShape{normal_, radius_m_, std::sqrt(std::max(cov(0, 0), cov(1, 1))), std::sqrt(cov(2, 2)), ellipses_};
  }

  Vec3 p_room_;
  std::vector<ContourRay> rays_;
  Vec3 to_cameras_ = Vec3::Zero();
  std::size_t ellipses_ = 0;
  Vec3 normal_ = Vec3::UnitZ();
  double radius_m_ = 0;
  double sum2_px2_ = 0, weights_ = 0;
};

}  // namespace

std::optional<MarkerShape> fit_shape(const Survey& survey, const Reconstruction& map,
                                     const std::vector<PointSight>& sights, const Vec3& p_room,
                                     const Vec3& normal_start_room) {
  constexpr std::size_t kMinEllipses = 3;
  ShapeFit fit(survey, map, sights, p_room);
  if (fit.ellipses() < kMinEllipses) return std::nullopt;
  return fit.run(normal_start_room);
}

}  // namespace roomcal::tools
