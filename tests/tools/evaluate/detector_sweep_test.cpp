#include "tools/evaluate/detector_sweep.h"

#include <gtest/gtest.h>

namespace roomcal::tools {
namespace {

/// A cell of 1000 markers, all found, with this RMS (both axes) and mean error along x.
CellResult cell_of(double diameter_px, double slant_deg, double rms_px, double mean_px) {
  CellResult cell;
  cell.spec = {diameter_px, slant_deg, 0.3, 2, false};
  cell.truths = cell.found = 1000;
  cell.sum_error_px = Vec2(1000 * mean_px, 0);
  cell.sum_error_error_px2 = Mat22::Identity() * (1000 * rms_px * rms_px / 2);
  cell.sum_nees = 2000;
  cell.bound_px2 = cell.bound_full_px2 = 0.01 * 0.01;
  return cell;
}

DetectorSweep good_sweep() { return {{cell_of(30, 45, 0.012, 0.001), cell_of(30, 70, 0.02, 0.001)}, 1}; }

bool all_met(const DetectorSweep& sweep) {
  for (const Bar& bar : judge_sweep(sweep)) {
    if (!bar.met) return false;
  }
  return true;
}

TEST(JudgeSweep, GoodCells_MeetEveryBar) { EXPECT_TRUE(all_met(good_sweep())); }

TEST(JudgeSweep, EachWeakness_FailsABar) {
  for (int weakness = 0; weakness < 6; ++weakness) {
    DetectorSweep sweep = good_sweep();
    CellResult& core = sweep.cells[0];
    CellResult& slanted = sweep.cells[1];
    if (weakness == 0) core = cell_of(30, 45, 0.016, 0.001);
    if (weakness == 1) core = cell_of(30, 45, 0.012, 0.004);
    if (weakness == 2) core.found = 994;
    if (weakness == 3) slanted.found = 949;
    if (weakness == 4) slanted.false_alarms = 1;
    if (weakness == 5) core.found = 1, core.truths = 1;  // too few to know the mean
    EXPECT_FALSE(all_met(sweep)) << weakness;
  }
}

TEST(JudgeSweep, NothingMeasured_MeetsNothingThatNeedsMarkers) { EXPECT_FALSE(all_met({})); }

TEST(CellResult, Figures_FollowFromTheSums) {
  const CellResult cell = cell_of(30, 45, 0.012, 0.001);
  EXPECT_NEAR(cell.rms_px(), 0.012, 1e-12);
  EXPECT_NEAR(cell.ratio(), 1.2, 1e-12);
  EXPECT_NEAR(cell.nees_half(), 1, 1e-12);
  EXPECT_NEAR(cell.mean_error_sigma_px(), 0.012 / std::sqrt(2000), 1e-5);
  const CellResult both = pool({cell, cell_of(30, 45, 0.02, -0.001)});
  EXPECT_EQ(both.truths, 2000);
  EXPECT_NEAR(both.mean_error_px().norm(), 0, 1e-12);
}

TEST(RunCells, MiddlingMarkers_AreFoundAndNearTheBound) {
  std::vector<std::byte> scratch;
  const auto cells = run_cells({40, 30, 0.3, 0, false}, {2, 5}, 1, scratch);
  ASSERT_EQ(cells.size(), 2u);
  EXPECT_GT(cells[0].recall(), 0.9);
  EXPECT_GT(cells[0].ratio(), 0.6);  // nobody beats the bound by more than chance: truth and bound would be wrong
  EXPECT_LT(cells[0].ratio(), 3);
  EXPECT_NEAR(cells[1].bound_rms_px() / cells[0].bound_rms_px(), std::sqrt((25 + 1.0 / 12) / (4 + 1.0 / 12)), 1e-9);
}

TEST(RunCells, ThinRings_AreSeenLessWellThanTheDefault) {
  std::vector<std::byte> scratch;
  CellSpec spec{15, 0, 0, 0, false};
  const double best = run_cells(spec, {2}, 1, scratch)[0].recall();
  spec.ring_radii = cctag3_radii(0);
  const double thin = run_cells(spec, {2}, 1, scratch)[0].recall();
  EXPECT_GT(best, 0.95);
  EXPECT_LT(thin, 0.5);
}

}  // namespace
}  // namespace roomcal::tools
