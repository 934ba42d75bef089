#include "runtime/pose/locate_camera.h"

#include <cmath>
#include <limits>
#include <string>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "tests/runtime/pose/scene.h"

namespace roomcal::pose {
namespace {

const std::vector<truth::RoomMarker>& room() {
  static const std::vector<truth::RoomMarker> markers = [] {
    truth::Random random(11);
    return truth::make_room(random);
  }();
  return markers;
}

const MapScene& sized_map() {
  static const MapScene scene = make_map_scene(room(), {}, 1);
  return scene;
}

const MapScene& bare_map() {
  static const MapScene scene = make_map_scene(room(), {false, 0.0}, 1);
  return scene;
}

bool is_right(const Located& located, const SE3& T_room_cam) {
  return (located.location.T_room_cam.t - T_room_cam.t).norm() < 0.05 &&
         rotation_angle_between(located.location.T_room_cam.R, T_room_cam.R) < deg_to_rad(1.0);
}

struct Tally {
  int right = 0;
  int wrong = 0;
  int refused = 0;
};

Tally locate_many(const MapScene& scene, truth::LensKind lens, const ShotOptions& shot, int count, uint64_t seed) {
  truth::Random random(seed);
  const camera::Camera camera = truth::make_camera(lens);
  const auto device = truth::make_device(random, 4, lens);
  Tally tally;
  for (int i = 0; i < count; ++i) {
    const SE3 T_room_cam = truth::random_T_room_rig(random) * device[static_cast<std::size_t>(i) % 4].T_rig_cam;
    const ImageScene image = make_image_scene(room(), camera, T_room_cam, shot, random);
    const Located located = locate(camera, image.observations, scene.index);
    if (!located.status.ok()) {
      ++tally.refused;
    } else {
      ++(is_right(located, T_room_cam) ? tally.right : tally.wrong);
    }
  }
  return tally;
}

TEST(LocateCamera, WideLensWithMissesAndFalseAlarms_AllRight) {
  const Tally tally = locate_many(sized_map(), truth::LensKind::kWide, {}, 40, 1);
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_EQ(tally.right, 40);
}

TEST(LocateCamera, FisheyeBeyond180Degrees_AllRight) {
  const Tally tally = locate_many(sized_map(), truth::LensKind::kFisheye, {}, 20, 2);
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_EQ(tally.right, 20);
}

TEST(LocateCamera, BearingsOnly_AllRight) {
  ShotOptions shot;
  shot.ellipses = false;
  shot.sigma_px = 0.3;
  const Tally tally = locate_many(bare_map(), truth::LensKind::kWide, shot, 15, 3);
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_EQ(tally.right, 15);
}

TEST(LocateCamera, FewMarkers_RightOrRefused) {
  for (const std::size_t most : {6u, 7u, 8u}) {
    ShotOptions shot;
    shot.most = most;
    shot.missed = 0.5;
    shot.false_alarms = 0;
    EXPECT_EQ(locate_many(sized_map(), truth::LensKind::kNarrow, shot, 15, 40 + most).wrong, 0) << most;
  }
}

TEST(LocateCamera, Inliers_AreTheTrueCorrespondences) {
  truth::Random random(5);
  const camera::Camera camera = truth::make_camera(truth::LensKind::kWide);
  const SE3 T_room_cam =
      truth::random_T_room_rig(random) * truth::make_device(random, 1, truth::LensKind::kWide)[0].T_rig_cam;
  const ImageScene image = make_image_scene(room(), camera, T_room_cam, {}, random);
  const Located located = locate(camera, image.observations, sized_map().index);
  ASSERT_TRUE(located.status.ok()) << located.status.detail();
  std::size_t wrong = 0;
  for (const Correspondence& inlier : located.inliers) {
    if (image.marker[inlier.observation] != static_cast<int>(inlier.marker)) ++wrong;
  }
  EXPECT_LE(wrong, 1u);  // a false alarm may land on a marker that was missed
  EXPECT_GE(located.inliers.size(), image.observations.size() * 7 / 10);
  EXPECT_LT(located.location.rms_px, 0.5);
  EXPECT_GT(located.location.coverage, 0.3);
  EXPECT_GT(located.location.log_likelihood_gap, 12.0);
}

TEST(LocateCamera, AnotherRoom_NotFound) {
  truth::Random random(6);
  const auto other = truth::make_room(random);
  const camera::Camera camera = truth::make_camera(truth::LensKind::kWide);
  for (int i = 0; i < 5; ++i) {
    const SE3 T_room_cam =
        truth::random_T_room_rig(random) * truth::make_device(random, 1, truth::LensKind::kWide)[0].T_rig_cam;
    const ImageScene image = make_image_scene(other, camera, T_room_cam, {}, random);
    EXPECT_EQ(locate(camera, image.observations, sized_map().index).status.code(), StatusCode::kNotFound);
  }
}

TEST(LocateCamera, RegularGrid_Ambiguous) {
  std::vector<truth::RoomMarker> grid;
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 12; ++x) grid.push_back({Vec3(0.3 * x, 0.3 * y, 0), Vec3::UnitZ()});
  }
  const MapScene scene = make_map_scene(grid, {}, 1);
  const camera::Camera camera = truth::make_camera(truth::LensKind::kNarrow);
  const SE3 T_room_cam{so3_exp(Vec3(kPi - 0.2, 0.1, 0.05)), Vec3(1.7, 1.6, 1.5)};
  truth::Random random(7);
  ShotOptions shot;
  shot.missed = shot.false_alarms = 0;
  const ImageScene image = make_image_scene(grid, camera, T_room_cam, shot, random);
  ASSERT_GE(image.observations.size(), 8u);
  const Located located = locate(camera, image.observations, scene.index);
  EXPECT_EQ(located.status.code(), StatusCode::kAmbiguous);
  EXPECT_TRUE(located.location.has_second);
}

TEST(LocateCamera, PoseThatTheMapLeavesOpen_BlamesTheMap) {
  const MapScene rough = make_map_scene(room(), {true, 0.01}, 1);
  truth::Random random(12);
  const camera::Camera camera = truth::make_camera(truth::LensKind::kWide);
  const SE3 T_room_cam =
      truth::random_T_room_rig(random) * truth::make_device(random, 1, truth::LensKind::kWide)[0].T_rig_cam;
  const ImageScene image = make_image_scene(room(), camera, T_room_cam, {}, random);
  LocateOptions options;
  options.max_sigma_m = 0.001;  // the rings tell it better, the map worse
  EXPECT_TRUE(locate(camera, image.observations, rough.index, options).status.ok());
  options.max_map_sigma_m = 0.001;
  const Status by_map = locate(camera, image.observations, rough.index, options).status;
  EXPECT_EQ(by_map.code(), StatusCode::kDegenerate);
  EXPECT_NE(std::string(by_map.detail()).find("survey the room again"), std::string::npos) << by_map.detail();
  options.max_sigma_m = 1e-6;
  const Status by_view = locate(camera, image.observations, rough.index, options).status;
  EXPECT_EQ(by_view.code(), StatusCode::kDegenerate);
  EXPECT_NE(std::string(by_view.detail()).find("markers in view"), std::string::npos) << by_view.detail();
}

TEST(LocateCamera, TooFewOrBadObservations_RefusedWithReason) {
  truth::Random random(8);
  const camera::Camera camera = truth::make_camera(truth::LensKind::kWide);
  const SE3 T_room_cam =
      truth::random_T_room_rig(random) * truth::make_device(random, 1, truth::LensKind::kWide)[0].T_rig_cam;
  ImageScene image = make_image_scene(room(), camera, T_room_cam, {}, random);
  EXPECT_EQ(locate(camera, {}, sized_map().index).status.code(), StatusCode::kTooFew);
  std::vector<Observation> five(image.observations.begin(), image.observations.begin() + 5);
  EXPECT_EQ(locate(camera, five, sized_map().index).status.code(), StatusCode::kTooFew);
  image.observations[3].centre_px.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(locate(camera, image.observations, sized_map().index).status.code(), StatusCode::kInvalidArgument);
  image.observations[3].centre_px.x() = 100;
  image.observations[4].cov_px2.setZero();
  EXPECT_EQ(locate(camera, image.observations, sized_map().index).status.code(), StatusCode::kInvalidArgument);
}

TEST(LocateCamera, SameInput_SameBytes) {
  truth::Random random(9);
  const camera::Camera camera = truth::make_camera(truth::LensKind::kWide);
  const SE3 T_room_cam =
      truth::random_T_room_rig(random) * truth::make_device(random, 1, truth::LensKind::kWide)[0].T_rig_cam;
  const ImageScene image = make_image_scene(room(), camera, T_room_cam, {}, random);
  const Located first = locate(camera, image.observations, sized_map().index);
  const Located again = locate(camera, image.observations, sized_map().index);
  EXPECT_EQ(first.location.T_room_cam.t, again.location.T_room_cam.t);
  EXPECT_EQ(first.location.T_room_cam.R, again.location.T_room_cam.R);
  EXPECT_EQ(first.location.hypotheses, again.location.hypotheses);
}

TEST(LocateCamera, EveryScratchThatIsTooSmall_IsRefused) {
  truth::Random random(10);
  const camera::Camera camera = truth::make_camera(truth::LensKind::kWide);
  const SE3 T_room_cam =
      truth::random_T_room_rig(random) * truth::make_device(random, 1, truth::LensKind::kWide)[0].T_rig_cam;
  const ImageScene image = make_image_scene(room(), camera, T_room_cam, {}, random);
  std::vector<std::byte> step_bytes(locate_step_bytes(image.observations.size()));
  std::size_t size = 0;
  Status status;
  for (;; size += 128) {
    std::vector<std::byte> bytes(size);
    Arena scratch(bytes);
    Arena step(step_bytes);
    CameraLocation location;
    status = locate_camera(camera, image.observations, sized_map().index, {}, step, scratch, location);
    EXPECT_EQ(scratch.used(), 0u);
    if (status.code() != StatusCode::kOutOfMemory) break;
  }
  EXPECT_TRUE(status.ok());
  EXPECT_LE(size, locate_scratch_bytes(image.observations.size()) + 128);
  EXPECT_GE(size + 512, locate_scratch_bytes(image.observations.size()));  // an honest bound, not a lavish one
  Arena no_step;
  Arena scratch;
  std::vector<std::byte> bytes(size);
  scratch = Arena(bytes);
  CameraLocation location;
  status = locate_camera(camera, image.observations, sized_map().index, {}, no_step, scratch, location);
  EXPECT_EQ(status.code(), StatusCode::kOutOfMemory);
  EXPECT_TRUE(location.inliers.empty());
}

// Mean of the normalized squared error over n runs is chi-square with 6 n degrees of freedom, over n.
void expect_honest_covariance(const MapScene& scene, uint64_t seed) {
  truth::Random random(seed);
  const camera::Camera camera = truth::make_camera(truth::LensKind::kWide);
  const auto device = truth::make_device(random, 4, truth::LensKind::kWide);
  double sum = 0;
  int count = 0;
  for (int i = 0; i < 60; ++i) {
    const SE3 T_room_cam = truth::random_T_room_rig(random) * device[static_cast<std::size_t>(i) % 4].T_rig_cam;
    ShotOptions shot;
    shot.sigma_px = 0.1;
    shot.false_alarms = 0;
    const ImageScene image = make_image_scene(room(), camera, T_room_cam, shot, random);
    const Located located = locate(camera, image.observations, scene.index);
    if (!located.status.ok()) continue;
    const Vec6 error = se3_log(located.location.T_room_cam.inverse() * T_room_cam);
    sum += error.dot(located.location.cov.ldlt().solve(error));
    ++count;
  }
  ASSERT_GE(count, 58);
  // 99.9 % band of chi-square with 360 degrees of freedom, normal approximation: 6 +- 3.3 sqrt(12 / n).
  EXPECT_NEAR(sum / count, 6.0, 3.3 * std::sqrt(12.0 / count));
}

TEST(LocateCamera, ExactMap_CovarianceIsHonest) { expect_honest_covariance(sized_map(), 21); }

TEST(LocateCamera, FiveMillimetreMapNoise_Found) {
  const MapScene noisy = make_map_scene(room(), {true, 0.005}, 3);
  const Tally tally = locate_many(noisy, truth::LensKind::kWide, {}, 15, 22);
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_EQ(tally.right, 15);
}

}  // namespace
}  // namespace roomcal::pose
