#include "runtime/scan/hypotheses.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tests/runtime/scan/simulated_sweep.h"
#include "tests/truth/random.h"

namespace roomcal::scan {
namespace {

using test::SimulatedSweep;

constexpr double kNever = 100;

struct Bench {
  Bench(const tools::LidarRoom& room, uint64_t seed)
      : bytes(Samples::bytes()), arena(bytes), sweep(room, pose(room, seed)) {
    EXPECT_TRUE(Samples::take(sweep.view(), sweep.sensor, arena, samples).ok());
  }
  static SE3 pose(const tools::LidarRoom& room, uint64_t seed) {
    tools::Random random(seed);
    return tools::random_lidar_pose(room.scene(), tools::Tilt::kTilted, random);
  }
  double score(const SE3& T, double give_up = kNever) const {
    return score_pose(sweep.room.surface(), samples.probe, T, give_up);
  }
  Hypotheses find(const PosePrior* prior) const {
    Hypotheses found;
    find_hypotheses(sweep.room.surface(), samples.probe, extract_planes(samples.fine, 0.018), prior, found);
    return found;
  }
  bool any_near(const Hypotheses& found, double within_m) const {
    return std::any_of(found.begin(), found.end(), [&](const Hypothesis& hypothesis) {
      const Vec6 off = se3_log(sweep.T_room_lidar.inverse() * hypothesis.T_room_lidar);
      return off.head<3>().norm() < within_m && off.tail<3>().norm() < 0.1;
    });
  }

  std::vector<std::byte> bytes;
  Arena arena;
  SimulatedSweep sweep;
  Samples samples;
};

const tools::LidarRoom& room() {
  static const tools::LidarRoom room(11);
  return room;
}

TEST(ScorePose, TruthAndPosesOffIt_AreFarApart) {
  const Bench bench(room(), 3);
  SE3 off = bench.sweep.T_room_lidar;
  EXPECT_LT(bench.score(off), 0.2);
  off.t.x() += 0.3;
  EXPECT_GT(bench.score(off), 0.4);
  off.t.x() += 50;
  EXPECT_GT(bench.score(off), 0.55);
}

TEST(ScorePose, HopelessOnes_AreGivenUpWithAScoreThatSaysSo) {
  const Bench bench(room(), 3);
  SE3 off = bench.sweep.T_room_lidar;
  off.t.x() += 0.5;
  const double whole = bench.score(off);
  EXPECT_GE(bench.score(off, 0.2 * whole), 0.2 * whole);
  EXPECT_EQ(bench.score(off, 2 * whole), whole);
}

TEST(FindHypotheses, WithAndWithoutPrior_OneIsNearTheTruthAndBestComesFirst) {
  truth::Random random(4);
  for (uint64_t seed = 0; seed < 8; ++seed) {
    const Bench bench(room(), seed);
    // Where two planes leave an axis open, it has five places without a prior.
    EXPECT_TRUE(bench.any_near(bench.find(nullptr), 0.5)) << seed;
    PosePrior prior;
    prior.cov = 0.013 * Mat66::Identity();
    prior.T_room_lidar = bench.sweep.T_room_lidar * se3_exp(0.11 * random.normals<6>());
    const Hypotheses found = bench.find(&prior);
    EXPECT_TRUE(bench.any_near(found, 0.15)) << seed;
    EXPECT_TRUE(
        std::is_sorted(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.score < b.score; }));
    for (const Hypothesis& hypothesis : found) EXPECT_TRUE(within_prior(prior, hypothesis.T_room_lidar));
  }
}

TEST(FindHypotheses, NoPlanes_LeavesThePriorAlone) {
  const Bench bench(room(), 1);
  Hypotheses found;
  PosePrior prior;
  prior.T_room_lidar = bench.sweep.T_room_lidar;
  find_hypotheses(room().surface(), bench.samples.probe, {}, &prior, found);
  ASSERT_EQ(found.size(), 1U);
  find_hypotheses(room().surface(), bench.samples.probe, {}, nullptr, found);
  EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace roomcal::scan
