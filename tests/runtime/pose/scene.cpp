#include "tests/runtime/pose/scene.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "tools/map/bake_triangles.h"

namespace roomcal::pose {
namespace {

/// Ellipse of a disc's image: its rim projected point by point, second moments taken.
void set_ellipse(const camera::Camera& camera, const SE3& T_room_cam, const truth::RoomMarker& marker,
                 Observation& observation) {
  const Vec3 u = marker.normal_room.unitOrthogonal();
  const Vec3 v = marker.normal_room.cross(u);
  constexpr int kRim = 32;
  Mat22 moments = Mat22::Zero();
  for (int i = 0; i < kRim; ++i) {
    const double angle = 2.0 * kPi * i / kRim;
    const Vec3 rim_room = marker.p_room + kRadius_m * (std::cos(angle) * u + std::sin(angle) * v);
    Vec2 px;
    if (!camera.project(T_room_cam.inverse() * rim_room, px).ok()) return;
    moments += (px - observation.centre_px) * (px - observation.centre_px).transpose() / kRim;
  }
  Eigen::SelfAdjointEigenSolver<Mat22> eigen(moments);  // a circle of radius 1 has moments 1/2
  observation.major_px = 2.0 * std::sqrt(2.0 * eigen.eigenvalues()[1]);
  observation.minor_px = 2.0 * std::sqrt(2.0 * eigen.eigenvalues()[0]);
  observation.angle_rad = std::atan2(eigen.eigenvectors()(1, 1), eigen.eigenvectors()(0, 1));
}

}  // namespace

MapScene make_map_scene(const std::vector<truth::RoomMarker>& room, const MapSceneOptions& options, uint64_t seed) {
  truth::Random random(seed);
  MapScene scene;
  for (std::size_t i = 0; i < room.size(); ++i) {
    map::MapMarker marker;
    marker.id = static_cast<uint32_t>(i);
    marker.p_room = room[i].p_room + options.sigma_m * random.normals<3>();
    marker.cov_m2 = options.sigma_m * options.sigma_m * Mat33::Identity();
    marker.normal_room = room[i].normal_room;  // an importer estimates it where the source has none
    marker.has_normal = true;
    marker.has_radius = options.sizes;
    marker.radius_m = options.sizes ? kRadius_m : 0;
    scene.markers.push_back(marker);
  }
  tools::BakeTrianglesOptions bake;
  bake.views = 300;
  scene.triples = tools::bake_triangles(scene.markers, bake);
  scene.bytes.resize(map::TriangleIndex::bytes(scene.markers.size(), scene.triples.size()));
  Arena permanent(scene.bytes);
  scene.index = map::TriangleIndex::build(scene.markers, scene.triples, permanent).value();
  return scene;
}

ImageScene make_image_scene(const std::vector<truth::RoomMarker>& room, const camera::Camera& camera,
                            const SE3& T_room_cam, const ShotOptions& options, truth::Random& random) {
  ImageScene scene;
  for (const truth::Sighting& sighting : truth::see_markers(room, camera, T_room_cam)) {
    if (random.uniform() < options.missed || scene.observations.size() >= options.most) continue;
    Observation o;
    o.centre_px = sighting.centre_px;
    o.cov_px2 = options.sigma_px * options.sigma_px * Mat22::Identity();
    if (options.ellipses) set_ellipse(camera, T_room_cam, room[sighting.marker], o);
    o.centre_px += options.sigma_px * random.normals<2>();
    o.major_px *= 1.0 + 0.01 * random.normal();
    o.minor_px = std::min(o.major_px, o.minor_px * (1.0 + 0.02 * random.normal()));
    scene.observations.push_back(o);
    scene.marker.push_back(sighting.marker);
  }
  const auto seen = scene.observations.size();
  const auto alarms = static_cast<std::size_t>(options.false_alarms * static_cast<double>(seen));
  for (std::size_t i = 0; i < alarms; ++i) {
    Observation o = scene.observations[random.index(seen)];  // looks like a marker, stands elsewhere
    o.centre_px = {random.uniform(0, camera.intrinsics().width_px - 1),
                   random.uniform(0, camera.intrinsics().height_px - 1)};
    scene.observations.push_back(o);
    scene.marker.push_back(-1);
  }
  return scene;
}

Located locate(const camera::Camera& camera, const std::vector<Observation>& observations,
               const map::TriangleIndex& index, const LocateOptions& options) {
  std::vector<std::byte> step_bytes(locate_step_bytes(observations.size()));
  std::vector<std::byte> scratch_bytes(locate_scratch_bytes(observations.size()));
  Arena step(step_bytes);
  Arena scratch(scratch_bytes);
  Located located;
  located.status = locate_camera(camera, observations, index, options, step, scratch, located.location);
  located.inliers.assign(located.location.inliers.begin(), located.location.inliers.end());
  located.location.inliers = {};
  return located;
}

}  // namespace roomcal::pose
