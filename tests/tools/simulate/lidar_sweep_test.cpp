#include "tools/simulate/lidar_sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tools/common/error.h"
#include "tools/simulate/make_room.h"

namespace roomcal::tools {
namespace {

constexpr double kTenthMillimetre = 1e-4;

const Scene& room() {
  static const Scene scene = make_room({.seed = 6, .pillar = true});
  return scene;
}
const SE3 kT_room_lidar{so3_exp(Vec3(0.2, -0.3, 0.9)), Vec3(0.8, 1.3, 1.2)};

BeamTable fine_beams() {
  BeamTable beams = vlp16_beams();
  beams.resolution_m = 1e-7;
  return beams;
}

SimulatedSweep quiet_sweep(const BeamTable& beams, const SE3& T_room_lidar = kT_room_lidar) {
  SweepFlaws flaws;
  flaws.sigma_m = 0;
  return SweepSimulator(room()).sweep(beams, flaws, T_room_lidar, 1);
}

Vec3 position_lidar(const lidar::SweepPoint& p) {
  return {static_cast<double>(p.x_m), static_cast<double>(p.y_m), static_cast<double>(p.z_m)};
}

/// How deep inside a body a point is; negative: so far outside.
double depth_in(const Body& body, const Vec3& p_room) {
  double outside_m = -std::numeric_limits<double>::infinity();
  for (const Plane& face : body.faces) outside_m = std::max(outside_m, face.signed_distance(p_room));
  return -outside_m;
}

/// Distance to the nearest surface, from plane equations alone: no ray is cast.
double off_surface_m(const Vec3& p_room) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Plane& wall : room().walls) nearest_m = std::min(nearest_m, std::abs(wall.signed_distance(p_room)));
  for (const Body& body : room().bodies) nearest_m = std::min(nearest_m, std::abs(depth_in(body, p_room)));
  return nearest_m;
}

TEST(SweepSimulator, WithoutNoise_EveryPointLiesOnASurfaceOfTheRoom) {
  const SimulatedSweep sweep = quiet_sweep(fine_beams());
  EXPECT_EQ(sweep.points.size(), 28'800U);
  std::size_t on_pillar = 0;
  for (const lidar::SweepPoint& point : sweep.points) {
    const Vec3 p_room = kT_room_lidar * position_lidar(point);
    ASSERT_LT(off_surface_m(p_room), kTenthMillimetre);
    for (const Plane& wall : room().walls) ASSERT_GT(wall.signed_distance(p_room), -kTenthMillimetre);
    for (const Body& body : room().bodies) on_pillar += std::abs(depth_in(body, p_room)) < kTenthMillimetre ? 1U : 0U;
  }
  EXPECT_GT(on_pillar, 300U);
}

TEST(SweepSimulator, NothingStandsBetweenTheSensorAndItsPoints) {
  for (const lidar::SweepPoint& point : quiet_sweep(fine_beams()).points) {
    for (const double part : {0.2, 0.4, 0.6, 0.8, 0.95, 0.999}) {
      const Vec3 p_room = kT_room_lidar * (part * position_lidar(point));
      for (const Body& body : room().bodies) ASSERT_LT(depth_in(body, p_room), kTenthMillimetre);
    }
  }
}

TEST(SweepSimulator, PointsLieOnTheirBeams) {
  const BeamTable beams = vlp16_beams();
  for (const lidar::SweepPoint& point : quiet_sweep(beams).points) {
    const Vec3 p = position_lidar(point);
    ASSERT_NEAR(std::asin(p.z() / p.norm()), beams.elevation_rad[point.beam], 1e-6);
    ASSERT_NEAR(std::remainder(std::atan2(p.x(), p.y()) - static_cast<double>(point.azimuth_rad), 2 * kPi), 0, 1e-6);
    ASSERT_NEAR(p.norm(), static_cast<double>(point.range_m), 1e-6);
    // 600 turns a minute: the angle is the time.
    ASSERT_NEAR(static_cast<double>(point.azimuth_rad) / (2 * kPi), 1e-8 * point.offset_ns, 1e-6);
    const double steps = static_cast<double>(point.range_m) / beams.resolution_m;
    ASSERT_NEAR(steps, std::round(steps), 1e-3);
  }
}

TEST(SweepSimulator, NoiseAndOffsets_AreWhatWasAsked) {
  const BeamTable beams = fine_beams();
  SweepFlaws flaws;
  flaws.sigma_m = 0.012;
  for (std::size_t i = 0; i < 16; ++i) flaws.beam_offset_m.push_back(0.004 * static_cast<double>(i) - 0.03);
  const SimulatedSweep quiet = quiet_sweep(beams);
  const SimulatedSweep noisy = SweepSimulator(room()).sweep(beams, flaws, kT_room_lidar, 1);
  ASSERT_EQ(noisy.points.size(), quiet.points.size());
  double squares = 0;
  std::vector<double> sum(16);
  for (std::size_t i = 0; i < noisy.points.size(); ++i) {
    const std::size_t beam = noisy.points[i].beam;
    const double error_m = static_cast<double>(noisy.points[i].range_m) - static_cast<double>(quiet.points[i].range_m) -
                           flaws.beam_offset_m[beam];
    squares += error_m * error_m;
    sum[beam] += error_m;
  }
  const auto count = static_cast<double>(noisy.points.size());
  EXPECT_NEAR(std::sqrt(squares / count), 0.012, 4 * 0.012 / std::sqrt(2 * count));
  for (const double beam_sum : sum) EXPECT_NEAR(16 * beam_sum / count, 0, 5 * 0.012 / std::sqrt(count / 16));
}

TEST(SweepSimulator, DropoutAndBlockedView_AreWhatWasAsked) {
  SweepFlaws flaws;
  flaws.dropout = 0.25;
  flaws.blocked_from_rad = 1;
  flaws.blocked_to_rad = 2;
  const SimulatedSweep sweep = SweepSimulator(room()).sweep(vlp16_beams(), flaws, kT_room_lidar, 1);
  EXPECT_NEAR(static_cast<double>(sweep.points.size()) / 28'800, 0.75, 4 * std::sqrt(0.25 * 0.75 / 28'800));
  for (const lidar::SweepPoint& point : sweep.points) {
    const bool blocked = point.azimuth_rad > 1.0001F && point.azimuth_rad < 1.9999F;
    if (blocked) {
      ASSERT_NEAR(point.range_m, 0.5, 0.1);
    }
  }
}

TEST(SweepSimulator, SameSeed_SameSweep) {
  const auto ranges = [](uint64_t seed) {
    std::vector<float> all;
    for (const lidar::SweepPoint& p : SweepSimulator(room()).sweep(vlp16_beams(), {}, kT_room_lidar, seed).points) {
      all.push_back(p.range_m);
    }
    return all;
  };
  EXPECT_EQ(ranges(3), ranges(3));
  EXPECT_NE(ranges(3), ranges(4));
}

TEST(SweepSimulator, TableWithoutBeams_IsRefused) { EXPECT_THROW(quiet_sweep(BeamTable{}), ToolError); }

}  // namespace
}  // namespace roomcal::tools
