#include "tools/simulate/marker_truth.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "tools/simulate/ray.h"

namespace roomcal::tools {

namespace {

constexpr int kOutlinePoints = 360;
constexpr int kDiscPoints = 400;

/// Places on the disc, in a sunflower's order: the same area each.
Vec2 disc_point(int i) {
  constexpr double kGoldenAngle_rad = 2.399963229728653;
  const double r = std::sqrt((i + 0.5) / kDiscPoints);
  return {r * std::cos(i * kGoldenAngle_rad), r * std::sin(i * kGoldenAngle_rad)};
}

/// One marker's disc before one camera.
class DiscView {
 public:
  /// @param mirror  in which it is seen; then the marker is its image behind that wall. Null: seen itself.
  DiscView(const Scene& scene, const camera::Camera& camera, const SE3& T_room_cam, const SceneMarker& marker,
           const Plane* mirror)
      : scene_(scene),
        camera_(camera),
        T_room_cam_(T_room_cam),
        T_cam_room_(T_room_cam.inverse()),
        marker_(marker),
        mirror_(mirror) {
    axis_u_ = marker.normal_room.unitOrthogonal();
    axis_v_ = marker.normal_room.cross(axis_u_);
  }

  Vec3 point_room(const Vec2& q) const {
    return marker_.centre_room + marker_.radius_m * (q.x() * axis_u_ + q.y() * axis_v_);
  }
  std::optional<Vec2> project(const Vec2& q) const {
    Vec2 px;
    if (!camera_.project(T_cam_room_ * point_room(q), px).ok()) return std::nullopt;
    return px;
  }
  double visible() const {
    int seen = 0;
    for (int i = 0; i < kDiscPoints; ++i) {
      const auto px = project(disc_point(i));
      seen += px && inside(*px) && !hidden(point_room(disc_point(i))) ? 1 : 0;
    }
    return static_cast<double>(seen) / kDiscPoints;
  }

 private:
  bool hidden(const Vec3& point) const {
    const Vec3& eye = T_room_cam_.t;
    if (mirror_ == nullptr) return is_hidden(scene_, eye, point);
    const Vec3 along = point - eye;
    const Vec3 glass = eye - mirror_->signed_distance(eye) / mirror_->normal.dot(along) * along;
    const Vec2 q = mirror_->coordinates(glass);
    const bool seen = std::any_of(mirror_->patches.begin(), mirror_->patches.end(),
                                  [&](const WallPatch& patch) { return patch.mirror && patch.covers(q); });
    return !seen || is_hidden(scene_, eye, glass) || is_hidden(scene_, glass, mirrored(*mirror_, point));
  }
  bool inside(const Vec2& px) const {
    const camera::Intrinsics& lens = camera_.intrinsics();
    return px.x() > -0.5 && px.y() > -0.5 && px.x() < lens.width_px - 0.5 && px.y() < lens.height_px - 0.5;
  }

  const Scene& scene_;
  const camera::Camera& camera_;
  SE3 T_room_cam_;
  SE3 T_cam_room_;
  const SceneMarker& marker_;
  const Plane* mirror_;
  Vec3 axis_u_ = Vec3::Zero();
  Vec3 axis_v_ = Vec3::Zero();
};

std::optional<MarkerTruth> project_marker(const DiscView& view, const SceneMarker& marker, const Vec3& eye_room) {
  const Vec3 to_eye = eye_room - marker.centre_room;
  const double facing = marker.normal_room.dot(to_eye) / to_eye.norm();
  const auto centre = view.project(Vec2::Zero());
  if (facing <= 0.01 || !centre) return std::nullopt;
  std::vector<Vec2> outline;
  for (int i = 0; i < kOutlinePoints; ++i) {
    const double angle = 2 * kPi * i / kOutlinePoints;
    const auto px = view.project(Vec2(std::cos(angle), std::sin(angle)));
    if (!px) return std::nullopt;
    outline.push_back(*px);
  }
  MarkerTruth truth{marker.id, *centre, measure_outline(outline), std::acos(facing), to_eye.norm(), view.visible()};
  if (truth.visible == 0) return std::nullopt;
  return truth;
}

}  // namespace

CircleImage measure_outline(const std::vector<Vec2>& outline_px) {
  // Green's theorem over the triangles that a middle point spans with the sides.
  Vec2 middle = Vec2::Zero();
  for (const Vec2& p : outline_px) middle += p / static_cast<double>(outline_px.size());
  double area = 0;
  Vec2 first = Vec2::Zero();
  Mat22 second = Mat22::Zero();
  for (std::size_t i = 0; i < outline_px.size(); ++i) {
    const Vec2 a = outline_px[i] - middle, b = outline_px[(i + 1) % outline_px.size()] - middle;
    const double twice = a.x() * b.y() - a.y() * b.x();
    area += twice / 2;
    first += twice / 6 * (a + b);
    second += twice / 24 * (a * a.transpose() + b * b.transpose() + (a + b) * (a + b).transpose());
  }
  const Vec2 centroid = first / area;
  const Mat22 moments = second / area - centroid * centroid.transpose();
  const Eigen::SelfAdjointEigenSolver<Mat22> axes(moments);
  CircleImage image;
  image.centre_px = middle + centroid;
  image.minor_px = 4 * std::sqrt(axes.eigenvalues()[0]);  // an ellipse's variance along an axis is a quarter of a^2
  image.major_px = 4 * std::sqrt(axes.eigenvalues()[1]);
  image.angle_rad = std::atan2(axes.eigenvectors()(1, 1), axes.eigenvectors()(0, 1));
  if (image.angle_rad > kPi / 2) image.angle_rad -= kPi;
  if (image.angle_rad <= -kPi / 2) image.angle_rad += kPi;
  return image;
}

std::vector<MarkerTruth> project_markers(const Scene& scene, const camera::Camera& camera, const SE3& T_room_cam) {
  std::vector<MarkerTruth> truths;
  for (const SceneMarker& marker : markers_of(scene)) {
    const DiscView view(scene, camera, T_room_cam, marker, nullptr);
    if (const auto truth = project_marker(view, marker, T_room_cam.t)) truths.push_back(*truth);
  }
  return truths;
}

std::vector<MarkerTruth> project_mirrored_markers(const Scene& scene, const camera::Camera& camera,
                                                  const SE3& T_room_cam) {
  std::vector<MarkerTruth> truths;
  for (const Plane& wall : scene.walls) {
    if (wall.patches.empty()) continue;
    for (SceneMarker marker : markers_of(scene)) {
      marker.centre_room = mirrored(wall, marker.centre_room);
      marker.normal_room -= 2 * wall.normal.dot(marker.normal_room) * wall.normal;
      const DiscView view(scene, camera, T_room_cam, marker, &wall);
      if (const auto truth = project_marker(view, marker, T_room_cam.t)) truths.push_back(*truth);
    }
  }
  return truths;
}

}  // namespace roomcal::tools
