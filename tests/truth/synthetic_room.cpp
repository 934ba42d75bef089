#include "tests/truth/synthetic_room.h"

#include <cmath>

#include <Eigen/Cholesky>

namespace roomcal::truth {

namespace {

constexpr double kSheetDistanceM = 0.2;
constexpr double kBorderPx = 10;
constexpr double kMaxSlantRad = deg_to_rad(75);

// One of the five surfaces, chosen by its area.
RoomMarker random_marker(Random& random) {
  const double w = kRoomSize_m.x(), l = kRoomSize_m.y(), h = kRoomSize_m.z();
  double pick = random.uniform(0, w * l + 2 * (w + l) * h);
  const double a = random.uniform(0.1, 0.9), b = random.uniform(0.1, 0.9);
  if ((pick -= w * l) < 0) return {{a * w, b * l, 0}, Vec3::UnitZ()};
  if ((pick -= w * h) < 0) return {{a * w, 0, b * h}, Vec3::UnitY()};
  if ((pick -= w * h) < 0) return {{a * w, l, b * h}, -Vec3::UnitY()};
  if ((pick -= l * h) < 0) return {{0, a * l, b * h}, Vec3::UnitX()};
  return {{w, a * l, b * h}, -Vec3::UnitX()};
}

bool fits(const std::vector<RoomMarker>& room, const RoomMarker& marker) {
  for (const RoomMarker& other : room)
    if ((other.p_room - marker.p_room).norm() < kSheetDistanceM) return false;
  return true;
}

// Columns: the camera's x right, y down, z forward, looking along +x of the rig (x forward, y left, z up).
Mat33 looking_forward() {
  Mat33 R_rig_cam;
  R_rig_cam << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return R_rig_cam;
}

template <int N>
Eigen::Matrix<double, N, 1> draw_from(Random& random, const Eigen::Matrix<double, N, N>& cov) {
  const Eigen::Matrix<double, N, N> L = cov.llt().matrixL();
  return L * random.normals<N>();
}

}  // namespace

std::vector<RoomMarker> make_room(Random& random, std::size_t count) {
  std::vector<RoomMarker> room;
  // Sheets that do not fit any more are left out rather than sought for ever.
  for (std::size_t tries = 0; room.size() < count && tries < 1000 * count; ++tries) {
    const RoomMarker marker = random_marker(random);
    if (fits(room, marker)) room.push_back(marker);
  }
  return room;
}

camera::Camera make_camera(LensKind lens) {
  using camera::Model;
  camera::Intrinsics narrow{
      Model::kPinholeRadtan, 1280, 1024, 1741.8, 1741.9, 627.1, 505.7, {-0.1237, 0.1183, 3.85e-4, -3.43e-4}};
  camera::Intrinsics wide{
      Model::kKannalaBrandt, 1280, 720, 612.2, 612.4, 634.9, 362.0, {-0.0190, 0.00449, -0.00175, 0.000338}};
  camera::Intrinsics fisheye{Model::kKannalaBrandt, 1920, 1920, 480, 481, 957, 962, {-0.01, 0.003, -0.0015, 0.0002}};
  const camera::Intrinsics& chosen = lens == LensKind::kNarrow ? narrow : lens == LensKind::kWide ? wide : fisheye;
  return camera::Camera::create(chosen).value();
}

std::vector<DeviceCamera> make_device(Random& random, std::size_t count, LensKind lens) {
  std::vector<DeviceCamera> device;
  for (std::size_t i = 0; i < count; ++i) {
    const double yaw_rad = 2 * kPi * static_cast<double>(i) / static_cast<double>(count);
    const SE3 T_rig_mount = {so3_exp({0, 0, yaw_rad}), so3_exp({0, 0, yaw_rad}) * Vec3(0.06, 0, 0)};
    Vec6 xi = random.normals<6>();
    xi.head<3>() *= 0.01;
    xi.tail<3>() *= deg_to_rad(3);
    device.push_back({make_camera(lens), T_rig_mount * SE3{looking_forward(), Vec3::Zero()} * se3_exp(xi)});
  }
  return device;
}

SE3 random_T_room_rig(Random& random) {
  const Vec3 position{0.5 * kRoomSize_m.x() + random.uniform(-0.4, 0.4),
                      0.5 * kRoomSize_m.y() + random.uniform(-0.6, 0.6), random.uniform(0.8, 1.4)};
  const Vec3 tilt_rad{random.uniform(-0.08, 0.08), random.uniform(-0.08, 0.08), 0};
  return {so3_exp({0, 0, random.uniform(-kPi, kPi)}) * so3_exp(tilt_rad), position};
}

std::vector<Sighting> see_markers(const std::vector<RoomMarker>& room, const camera::Camera& camera,
                                  const SE3& T_room_cam) {
  const SE3 T_cam_room = T_room_cam.inverse();
  const double width_px = camera.intrinsics().width_px, height_px = camera.intrinsics().height_px;
  std::vector<Sighting> sightings;
  for (std::size_t i = 0; i < room.size(); ++i) {
    const Vec3 to_camera_room = T_room_cam.t - room[i].p_room;
    if (to_camera_room.dot(room[i].normal_room) < std::cos(kMaxSlantRad) * to_camera_room.norm()) continue;
    Vec2 px;
    if (!camera.project(T_cam_room * room[i].p_room, px).ok()) continue;
    if (px.x() < kBorderPx || px.x() > width_px - 1 - kBorderPx) continue;
    if (px.y() < kBorderPx || px.y() > height_px - 1 - kBorderPx) continue;
    sightings.push_back({static_cast<uint16_t>(i), px});
  }
  return sightings;
}

Mat22 random_cov_px2(Random& random, double min_sigma_px, double max_sigma_px) {
  const double angle_rad = random.uniform(0, kPi);
  Mat22 R;
  R << std::cos(angle_rad), -std::sin(angle_rad), std::sin(angle_rad), std::cos(angle_rad);
  const Vec2 sigma_px(random.uniform(min_sigma_px, max_sigma_px), random.uniform(min_sigma_px, max_sigma_px));
  return R * Vec2(sigma_px.array().square()).asDiagonal() * R.transpose();
}

Vec2 draw(Random& random, const Mat22& cov) { return draw_from<2>(random, cov); }
Vec3 draw(Random& random, const Mat33& cov) { return draw_from<3>(random, cov); }

}  // namespace roomcal::truth
