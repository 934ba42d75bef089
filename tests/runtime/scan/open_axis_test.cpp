#include "runtime/scan/open_axis.h"

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

struct Search {
  explicit Search(const SimulatedSweep& of) : sweep(of), bytes(AxisScratch::bytes()), arena(bytes) {
    EXPECT_TRUE(AxisScratch::build(arena, scratch).ok());
  }

  /// Refines from a pose, looks along the weakest axis. @return the axis.
  OpenAxis run(const SE3& start) {
    RefineInput input = sweep.input();
    fine.state.T_room_lidar = start;
    refine(sweep.view(), input, fine);
    before = fine.state;
    const Mat66 information = condense(fine.sums, sweep.sensor, fine.linearized_at).information;
    const OpenAxis open = open_axis_of(information, fine.state.T_room_lidar.R, nullptr, 0.45);
    search_axis(sweep.view(), open, scratch, fine, input);
    return open;
  }

  const SimulatedSweep& sweep;
  std::vector<std::byte> bytes;
  Arena arena;
  AxisScratch scratch;
  FineSolution fine;
  RangeState before;
};

TEST(OpenAxisOf, InformationWithoutHeight_IsTheHeight) {
  const Mat33 R = so3_exp(Vec3(0.3, 0.2, 0.1));
  Vec6 up = Vec6::Zero();
  up.head<3>() = R.transpose() * Vec3::UnitZ();
  const Mat66 information = 1e8 * (Mat66::Identity() - up * up.transpose()) + 400 * up * up.transpose();
  const OpenAxis open = open_axis_of(information, R, nullptr, 0.45);
  EXPECT_TRUE(open.open);
  EXPECT_NEAR(std::abs(open.axis_room.z()), 1, 1e-6);
  EXPECT_NEAR(open.sigma_m, 0.05, 0.001);
  EXPECT_EQ(open.reach_m, 0.45);
  PosePrior prior;
  prior.cov = 0.04 * Mat66::Identity();
  EXPECT_NEAR(open_axis_of(information, R, &prior, 0.45).reach_m, 0.6, 1e-9);
  EXPECT_FALSE(open_axis_of(1e6 * Mat66::Identity(), R, nullptr, 0.45).open);
}

TEST(SearchAxis, StripOfFloorAtTheWallsFoot_GivesTheHeight) {
  // 0.72 m above the floor the lowest beam reaches it 2.7 m away: in the corners only.
  const SimulatedSweep sweep(room(), {so3_exp(Vec3(0, 0, 0.7)), Vec3(1.2, 1.4, 0.72)});
  for (const double off_m : {-0.15, 0.1, 0.2}) {
    Search search(sweep);
    SE3 start = sweep.T_room_lidar;
    start.t.z() += off_m;
    search.run(start);
    EXPECT_LT(std::abs(search.fine.state.T_room_lidar.t.z() - 0.72), 0.005) << off_m;
    EXPECT_TRUE(search.fine.converged);
  }
}

TEST(SearchAxis, NothingShowsTheHeight_StaysWhereItIs) {
  const SimulatedSweep sweep(room(), {so3_exp(Vec3(0, 0, 0.7)), Vec3(1.2, 1.4, 1.35)});
  Search search(sweep);
  const OpenAxis open = search.run(sweep.T_room_lidar);
  EXPECT_TRUE(open.open);
  EXPECT_NEAR(std::abs(open.axis_room.z()), 1, 0.01);
  EXPECT_EQ(search.fine.state.T_room_lidar.t, search.before.T_room_lidar.t);
}

TEST(SearchAxis, RightPlace_StaysWhereItIs) {
  const SimulatedSweep sweep(room(), {so3_exp(Vec3(0.3, 0.2, 1)), Vec3(1.1, 2.2, 1.3)});
  Search search(sweep);
  search.run(sweep.T_room_lidar);
  EXPECT_EQ(search.fine.state.T_room_lidar.t, search.before.T_room_lidar.t);
  EXPECT_LT(sweep.error_m(search.fine.state), 0.002);
}

TEST(AxisScratch, ArenaTooSmall_IsRefused) {
  std::vector<std::byte> bytes(AxisScratch::bytes() / 2);
  Arena arena{bytes};
  AxisScratch scratch;
  EXPECT_EQ(AxisScratch::build(arena, scratch).code(), StatusCode::kOutOfMemory);
}

}  // namespace
}  // namespace roomcal::scan
