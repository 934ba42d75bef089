#include "tools/map/plane_refit.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "runtime/map/plane_error.h"
#include "tests/tools/map/box_room.h"
#include "tools/map/noise.h"
#include "tools/map/plane_fit.h"

namespace roomcal::tools {
namespace {

PlaneMembers members_of(const MapData& data, int plane) {
  PlaneMembers members;
  for (std::size_t i = 0; i < data.markers.size(); ++i)
    if (data.markers[i].plane == plane) members.push_back(i);
  return members;
}

/// Error (offset, tilt, tilt) of a plane against the true one of the same side: what the true signed distances are
/// more.
Vec3 error_of(const map::MapPlane& plane, const Vec3& true_normal, double true_d_m) {
  const Vec2 tilt = map::plane_axes(plane.normal_room).transpose() * true_normal;
  return {true_d_m - plane.d_m, tilt.x(), tilt.y()};
}

TEST(PlaneCovariance, OfDeclaredNoise_DescribesTheErrorsOfRefittedPlanes) {
  constexpr int kMaps = 200;
  MapData exact = test::box_room(40, 0, 1);
  exact.planes = fit_planes(exact.markers);
  ASSERT_EQ(exact.planes.size(), 5U);
  double sum = 0;
  for (int i = 0; i < kMaps; ++i) {
    MapData noisy = exact;
    add_noise(noisy, 0.003, static_cast<uint64_t>(i) + 1, true);
    for (std::size_t k = 0; k < 5; ++k) {
      const map::MapPlane& plane = noisy.planes[k].plane;
      const Vec3 error = error_of(plane, exact.planes[k].plane.normal_room, exact.planes[k].plane.d_m);
      sum += error.dot(plane.cov.ldlt().solve(error)) / (5 * kMaps);
    }
  }
  // Chi-square with three degrees of freedom; excess that is chance makes some covariances wider, by a percent or two.
  EXPECT_NEAR(sum, 3, 0.3);
}

TEST(PlaneCovariance, ExactMarkers_MakeAnExactPlane) {
  MapData data = test::box_room(40, 0, 2);
  for (const PlaneData& plane : fit_planes(data.markers)) EXPECT_TRUE(plane.plane.cov.isZero(0));
}

TEST(PlaneCovariance, WallThatIsNotFlat_IsUncertainByWhatItsMarkersScatter) {
  MapData data = test::box_room(60, 0.004, 3);  // and no marker says so
  data.planes = fit_planes(data.markers);
  for (std::size_t k = 0; k < data.planes.size(); ++k) {
    const map::MapPlane& plane = data.planes[k].plane;
    Vec3 middle = Vec3::Zero();
    const PlaneMembers members = members_of(data, static_cast<int>(k));
    for (const std::size_t i : members) middle += data.markers[i].p_room / static_cast<double>(members.size());
    const Vec3 lever = map::plane_lever(plane.normal_room, middle);
    const double expected_m = plane.rms_m / std::sqrt(static_cast<double>(members.size()));
    EXPECT_NEAR(std::sqrt(lever.dot(plane.cov * lever)), expected_m, 0.1 * expected_m);
  }
}

TEST(RefitPlanes, MovedMarkers_TakeTheirPlaneAlongAndItsSideStays) {
  MapData data = test::box_room(30, 0, 4);
  data.planes = fit_planes(data.markers);
  const MapData before = data;
  for (map::MapMarker& marker : data.markers) marker.p_room += Vec3(0.01, 0.02, 0.03);
  refit_planes(data);
  for (std::size_t k = 0; k < data.planes.size(); ++k) {
    const map::MapPlane &was = before.planes[k].plane, &is = data.planes[k].plane;
    EXPECT_GT(was.normal_room.dot(is.normal_room), 1 - 1e-9);
    EXPECT_NEAR(is.d_m, was.d_m - was.normal_room.dot(Vec3(0.01, 0.02, 0.03)), 1e-9);
  }
  EXPECT_FALSE(data.corners.empty());
}

}  // namespace
}  // namespace roomcal::tools
