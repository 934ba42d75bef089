#include "runtime/scan/refine.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/runtime/scan/simulated_sweep.h"

namespace roomcal::scan {
namespace {

using test::SimulatedSweep;

const tools::LidarRoom& room() {
  static const tools::LidarRoom room(11);
  return room;
}

const SE3 kTilted{so3_exp(Vec3(0.3, 0.2, 1)), Vec3(1.1, 2.2, 1.3)};
/// Level, and so high above the floor that no beam reaches it, nor the ceiling.
const SE3 kLevel{so3_exp(Vec3(0, 0, 0.7)), Vec3(1.2, 1.4, 1.35)};

SE3 moved(const SE3& T, double rho_m, double phi_rad) {
  return T * se3_exp((Vec6() << rho_m, -rho_m, 0.5 * rho_m, phi_rad, 0.5 * phi_rad, -phi_rad).finished());
}

struct Sampled {
  explicit Sampled(const SimulatedSweep& of) : bytes(Samples::bytes()), arena(bytes) {
    EXPECT_TRUE(Samples::take(of.view(), of.sensor, arena, samples).ok());
  }
  std::vector<std::byte> bytes;
  Arena arena;
  Samples samples;
};

TEST(Settle, CoarsePoses_ComeToTheOptimumOfTheSample) {
  const SimulatedSweep sweep(room(), kTilted);
  const Sampled sampled(sweep);
  for (const double sign : {-1.0, 1.0}) {
    RangeState state;
    state.T_room_lidar = moved(kTilted, sign * 0.12, sign * 0.07);
    settle(sampled.samples.coarse, sweep.input(), 0.35, state);
    EXPECT_LT(sweep.error_m(state), 0.01);
    EXPECT_LT(rotation_angle_between(state.T_room_lidar.R, kTilted.R), deg_to_rad(0.3));
  }
}

TEST(Refine, SettledPose_ConvergesOverAllPoints) {
  const SimulatedSweep sweep(room(), kTilted);
  RefineInput input = sweep.input();
  FineSolution fine;
  fine.state.T_room_lidar = moved(kTilted, 0.01, 0.003);
  refine(sweep.view(), input, fine);
  EXPECT_TRUE(fine.converged);
  EXPECT_LT(sweep.error_m(fine.state), 0.002);
  EXPECT_EQ(fine.sums.valid, sweep.points.points.size());
  EXPECT_GT(fine.sums.inliers, 0.999 * fine.sums.valid);
  const Vec6 since = se3_log(fine.linearized_at.T_room_lidar.inverse() * fine.state.T_room_lidar);
  EXPECT_LT(since.dot(condense(fine.sums, sweep.sensor, fine.linearized_at).information * since), 0.33 * 0.33);
}

TEST(Refine, FloorThatOnlyAWrongHeightShows_IsMuted) {
  const SimulatedSweep sweep(room(), kLevel);
  RefineInput input = sweep.input();
  FineSolution fine;
  fine.state.T_room_lidar = kLevel;
  fine.state.T_room_lidar.t.z() -= 0.7;  // from here the lowest beams should see it, and the walls are where they were
  refine(sweep.view(), input, fine);
  const Mat66 information = condense(fine.sums, sweep.sensor, fine.linearized_at).information;
  EXPECT_LT(information(2, 2), 1e4);  // a height unknown to a centimetre and more
  for (std::size_t i = 0; i < room().surface().faces().size(); ++i) {
    const bool level = std::abs(room().surface().faces()[i].normal_room.z()) > 0.9;
    if (level && fine.sums.face[i].predicted > 0) {
      EXPECT_EQ(input.mute >> i & 1U, 1U) << i;
    }
  }
}

TEST(SpreadM, NoiseOfASweep_IsMeasuredAndNeverBelowTheSensors) {
  std::vector<float> scratch(Samples::kMaxRays);
  for (const double sigma_m : {0.002, 0.015, 0.017, 0.03}) {
    tools::SweepFlaws flaws;
    flaws.sigma_m = sigma_m;
    const SimulatedSweep sweep(room(), kTilted, flaws);
    const Sampled sampled(sweep);
    RangeState state;
    state.T_room_lidar = kTilted;
    const double spread = spread_m(sampled.samples.fine, sweep.input(), state, scratch);
    EXPECT_NEAR(spread, sigma_m < 0.018 ? 0.015 : sigma_m, 0.05 * sigma_m) << sigma_m;
  }
}

}  // namespace
}  // namespace roomcal::scan
