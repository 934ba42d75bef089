#include "runtime/scan/print_fit.h"

#include <vector>

#include <gtest/gtest.h>

#include "tools/evaluate/lidar_trial.h"

namespace roomcal::scan {
namespace {

struct Bench {
  explicit Bench(uint64_t seed) {
    tools::Random random(seed);
    T_room_lidar = tools::random_lidar_pose(room.scene(), tools::Tilt::kUpright, random);
    sweep = room.simulator().sweep(tools::vlp16_beams(), {}, T_room_lidar, seed);
  }
  PrintFit fit(double shifted_m, double reach_m) {
    bytes.resize(PrintMatcher::bytes());
    Arena scratch{bytes};
    PrintMatcher matcher;
    EXPECT_TRUE(PrintMatcher::build(scratch, matcher).ok());
    RangeState state;
    state.T_room_lidar = T_room_lidar;
    state.T_room_lidar.t.z() += shifted_m;
    const lidar::Sweep view = sweep.view();
    return matcher.fit(room.surface(), {{&view, 1}}, {}, state, Vec3::UnitZ(), reach_m);
  }

  inline static const tools::LidarRoom room{13};  // one for all: making it is half of the test
  SE3 T_room_lidar;
  tools::SimulatedSweep sweep;
  std::vector<std::byte> bytes;
};

TEST(PrintFit, HeightOffByDecimetres_IsMeasuredToAMillimetreWithAnHonestSigma) {
  double squares = 0;
  int clear = 0;
  for (uint64_t seed = 0; seed < 8; ++seed) {
    Bench bench(seed);
    const double shifted_m = 0.04 * (static_cast<double>(seed) - 3.5);
    const PrintFit fit = bench.fit(shifted_m, 0.3);
    if (!fit.clear) continue;
    ++clear;
    EXPECT_NEAR(fit.shift_m, -shifted_m, 0.003) << "seed " << seed;
    EXPECT_LT(fit.sigma_m, 0.003);
    squares += std::pow((fit.shift_m + shifted_m) / fit.sigma_m, 2);
  }
  EXPECT_GE(clear, 6);
  EXPECT_LT(squares / clear, 3);
}

TEST(PrintFit, PoseElsewhere_IsNotClear) {
  for (uint64_t seed = 0; seed < 4; ++seed) {
    Bench bench(seed);
    bench.T_room_lidar.t.x() += 0.4;  // sheets are then nowhere near their returns
    EXPECT_FALSE(bench.fit(0, 0.3).clear) << "seed " << seed;
  }
}

TEST(PrintFit, NoReflectivity_IsNotClear) {
  Bench bench(2);
  for (lidar::SweepPoint& point : bench.sweep.points) point.reflectivity = 0;
  EXPECT_FALSE(bench.fit(0, 0.3).clear);
}

TEST(PrintMatcher, ArenaTooSmall_IsRefused) {
  std::vector<std::byte> bytes(1000);
  Arena scratch{bytes};
  PrintMatcher matcher;
  EXPECT_EQ(PrintMatcher::build(scratch, matcher).code(), StatusCode::kOutOfMemory);
}

}  // namespace
}  // namespace roomcal::scan
