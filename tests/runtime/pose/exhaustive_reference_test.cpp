// The paper's Algorithm 2 as published, slow: image triangles against every map triple with edges up to 1 m in all six
// orders, inliers counted over the whole map. What it finds, the index must find.

#include <algorithm>
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/pose/image_triangles.h"
#include "runtime/pose/p3p.h"
#include "tests/runtime/pose/scene.h"

namespace roomcal::pose {
namespace {

constexpr double kLongestEdge_m = 1.0;
constexpr double kGate_rad = 0.01;

std::vector<map::MarkerTriple> all_triples(const std::vector<truth::RoomMarker>& room) {
  std::vector<map::MarkerTriple> triples;
  const auto near = [&](std::size_t i, std::size_t j) {
    return (room[i].p_room - room[j].p_room).norm() <= kLongestEdge_m;
  };
  for (std::size_t i = 0; i < room.size(); ++i) {
    for (std::size_t j = i + 1; j < room.size(); ++j) {
      for (std::size_t k = j + 1; near(i, j) && k < room.size(); ++k) {
        if (near(i, k) && near(j, k)) {
          triples.push_back({static_cast<uint16_t>(i), static_cast<uint16_t>(j), static_cast<uint16_t>(k)});
        }
      }
    }
  }
  return triples;
}

std::size_t count_inliers(const SE3& T_room_cam, const std::vector<truth::RoomMarker>& room,
                          const std::vector<Vec3>& bearing_cam) {
  const SE3 T_cam_room = T_room_cam.inverse();
  std::vector<bool> seen(bearing_cam.size(), false);
  for (const truth::RoomMarker& marker : room) {
    if (marker.normal_room.dot(T_room_cam.t - marker.p_room) <= 0) continue;
    const Vec3 direction = (T_cam_room * marker.p_room).normalized();
    for (std::size_t i = 0; i < bearing_cam.size(); ++i) {
      if ((bearing_cam[i] - direction).squaredNorm() < kGate_rad * kGate_rad) seen[i] = true;
    }
  }
  return static_cast<std::size_t>(std::count(seen.begin(), seen.end(), true));
}

struct Best {
  std::size_t inliers = 0;
  SE3 T_room_cam;
};

Best algorithm_2(const std::vector<truth::RoomMarker>& room, const std::vector<Vec3>& bearing_cam,
                 std::size_t image_triangles_tried) {
  std::vector<std::byte> bytes(image_triangles_bytes(bearing_cam.size()));
  Arena arena(bytes);
  std::span<Triple> triangles;
  EXPECT_TRUE(image_triangles(bearing_cam, {}, arena, triangles).ok());
  Best best;
  P3pPoses poses;
  for (const Triple& t : triangles.first(std::min(image_triangles_tried, triangles.size()))) {
    const std::array<Vec3, 3> bearing = {bearing_cam[t[0]], bearing_cam[t[1]], bearing_cam[t[2]]};
    const P3pBearings prepared{std::span<const Vec3, 3>(bearing)};
    for (map::MarkerTriple triple : all_triples(room)) {
      do {  // all_triples() gives them sorted: every order comes
        const std::array<Vec3, 3> point = {room[triple[0]].p_room, room[triple[1]].p_room, room[triple[2]].p_room};
        if (!solve_p3p(prepared, std::span<const Vec3, 3>(point), poses).ok()) continue;
        for (const SE3& T_room_cam : poses) {
          const std::size_t inliers = count_inliers(T_room_cam, room, bearing_cam);
          if (inliers > best.inliers) best = {inliers, T_room_cam};
        }
      } while (std::next_permutation(triple.begin(), triple.end()));
    }
  }
  return best;
}

TEST(ExhaustiveReference, SmallRoom_IndexFindsWhatAlgorithm2Finds) {
  truth::Random random(31);
  const auto room = truth::make_room(random, 120);
  const camera::Camera camera = truth::make_camera(truth::LensKind::kWide);
  for (const bool sizes : {true, false}) {
    const MapScene scene = make_map_scene(room, {sizes, 0.0}, 1);
    const SE3 T_room_cam =
        truth::random_T_room_rig(random) * truth::make_device(random, 1, truth::LensKind::kWide)[0].T_rig_cam;
    ShotOptions shot;
    shot.missed = 0.1;
    shot.false_alarms = 0.1;
    shot.ellipses = sizes;
    const ImageScene image = make_image_scene(room, camera, T_room_cam, shot, random);
    std::vector<Vec3> bearing_cam(image.observations.size());
    for (std::size_t i = 0; i < bearing_cam.size(); ++i) {
      ASSERT_TRUE(camera.unproject(image.observations[i].centre_px, bearing_cam[i]).ok());
    }
    const Best reference = algorithm_2(room, bearing_cam, 4);
    const Located located = locate(camera, image.observations, scene.index);
    ASSERT_TRUE(located.status.ok()) << located.status.detail();
    EXPECT_LT((located.location.T_room_cam.t - T_room_cam.t).norm(), 0.02);
    EXPECT_GE(count_inliers(located.location.T_room_cam, room, bearing_cam), reference.inliers);
  }
}

}  // namespace
}  // namespace roomcal::pose
