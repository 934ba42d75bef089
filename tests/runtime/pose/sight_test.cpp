#include "runtime/pose/sight.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/truth/synthetic_room.h"

namespace roomcal::pose {
namespace {

/// Observations all over an image, and their sights.
struct Sights {
  explicit Sights(truth::LensKind lens, std::size_t count = 60) : camera(truth::make_camera(lens)), bytes(1 << 17) {
    truth::Random random(3);
    const camera::Intrinsics& k = camera.intrinsics();
    for (std::size_t i = 0; i < count; ++i) {
      Observation o;
      o.centre_px = Vec2(random.uniform() * (k.width_px - 1), random.uniform() * (k.height_px - 1));
      o.cov_px2 = truth::random_cov_px2(random, 0.05, 0.2);
      observations.push_back(o);
    }
  }
  Status make() {
    Arena arena(bytes);
    return make_sights(camera, observations, 3.0, arena, set);
  }

  camera::Camera camera;
  std::vector<Observation> observations;
  std::vector<std::byte> bytes;
  SightSet set;
};

TEST(MakeSights, Bearings_ProjectBackToTheirPixels) {
  for (const auto lens : {truth::LensKind::kNarrow, truth::LensKind::kWide, truth::LensKind::kFisheye}) {
    Sights sights(lens);
    ASSERT_TRUE(sights.make().ok());
    ASSERT_FALSE(sights.set.sights.empty());
    double last_x = -2;
    for (const Sight& sight : sights.set.sights) {
      Vec2 px;
      ASSERT_TRUE(sights.camera.project(sight.bearing_cam, px).ok());
      EXPECT_LT((px - sights.observations[sight.observation].centre_px).norm(), 1e-6);
      EXPECT_GE(sight.bearing_cam.x(), last_x);
      EXPECT_GE(sights.set.axis_cam.dot(sight.bearing_cam), sights.set.cos_field);
      last_x = sight.bearing_cam.x();
    }
  }
}

/// A pixel's step to the side, carried to the sphere by the derivative, against the bearing of the pixel beside it.
TEST(MakeSights, Covariance_FollowsTheCamerasDerivative) {
  Sights sights(truth::LensKind::kWide);
  ASSERT_TRUE(sights.make().ok());
  for (const Sight& sight : sights.set.sights) {
    const Vec2 step_px(0.01, -0.02);
    Vec3 moved_cam;
    ASSERT_TRUE(sights.camera.unproject(sights.observations[sight.observation].centre_px + step_px, moved_cam).ok());
    const Vec2 moved_rad = sight.tangent.transpose() * moved_cam;
    EXPECT_LT((moved_rad - sight.rad_per_px * step_px).norm(), 1e-3 * moved_rad.norm());
    const Mat22 cov = sight.rad_per_px * sights.observations[sight.observation].cov_px2 * sight.rad_per_px.transpose();
    EXPECT_LT((cov - sight.cov_rad2).norm(), 1e-12);
  }
}

TEST(NearestSight, AnyDirection_IsWhatASearchThroughAllFinds) {
  Sights sights(truth::LensKind::kWide);
  ASSERT_TRUE(sights.make().ok());
  truth::Random random(9);
  int found = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 direction = (sights.set.axis_cam + 0.8 * random.normals<3>()).normalized();
    const double gate_rad = 0.2 * random.uniform();
    int expected = -1;
    double best = gate_rad;
    for (std::size_t k = 0; k < sights.set.sights.size(); ++k) {
      const double distance = (sights.set.sights[k].bearing_cam - direction).norm();
      if (distance > best) continue;
      best = distance;
      expected = static_cast<int>(k);
    }
    EXPECT_EQ(nearest_sight(sights.set, direction, gate_rad), expected);
    found += expected >= 0 ? 1 : 0;
  }
  EXPECT_GT(found, 200);
}

TEST(MakeSights, ObservationsThatAreNone_AreRefused) {
  for (int fault = 0; fault < 4; ++fault) {
    Sights sights(truth::LensKind::kNarrow, 10);
    Observation& o = sights.observations[7];
    if (fault == 0) o.centre_px.x() = std::numeric_limits<double>::quiet_NaN();
    if (fault == 1) o.cov_px2(0, 0) = 0;
    if (fault == 2) o.cov_px2(0, 1) = o.cov_px2(1, 0) = 1;
    if (fault == 3) o.major_px = std::numeric_limits<double>::infinity();
    EXPECT_EQ(sights.make().code(), StatusCode::kInvalidArgument) << fault;
  }
}

TEST(MakeSights, OutsideTheLensesField_IsLeftOut) {
  Sights sights(truth::LensKind::kFisheye, 10);
  sights.observations[4].centre_px = Vec2(-50000, 10);
  ASSERT_TRUE(sights.make().ok());
  for (const Sight& sight : sights.set.sights) EXPECT_NE(sight.observation, 4);
}

}  // namespace
}  // namespace roomcal::pose
