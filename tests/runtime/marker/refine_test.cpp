#include "runtime/marker/refine.h"

#include <cmath>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/runtime/marker/outer_ellipse.h"
#include "tests/truth/marker_patch.h"

namespace roomcal::marker {
namespace {

using truth::MarkerPatch;

// Seeded numbers in [-1, 1).
class Draw {
 public:
  explicit Draw(uint32_t seed) : state_(seed) {}
  double operator()() {
    state_ = state_ * 1664525U + 1013904223U;
    return (state_ >> 8) / 8388608.0 - 1;
  }

 private:
  uint32_t state_;
};

MarkerPatch patch_of(double diameter_px, double slant_deg, Draw& draw) {
  MarkerPatch patch;
  patch.width = patch.height = static_cast<int>(1.6 * diameter_px) + 40;
  const Vec2 centre{patch.width / 2.0 + draw(), patch.height / 2.0 + draw()};
  const double azimuth_rad = kPi * draw(), roll_rad = kPi * draw();
  patch.H_px_plane = truth::marker_homography(centre, diameter_px, deg_to_rad(slant_deg), azimuth_rad, roll_rad, 900);
  patch.diameter_px = diameter_px;
  return patch;
}

Candidate candidate_of(const MarkerPatch& patch, double error, Draw& draw) {
  Candidate candidate{outer_ellipse(patch.H_px_plane)};
  const double reach_px = error * candidate.outer.minor_px / 2;
  candidate.outer.centre_px += reach_px * Vec2{draw(), draw()};
  candidate.outer.major_px *= 1 + error * draw();
  candidate.outer.minor_px *= 1 + error * draw();
  return candidate;
}

class Refine : public testing::Test {
 protected:
  Status run(const MarkerPatch& patch, const std::vector<uint8_t>& pixels, const Candidate& candidate,
             Detection& detection) {
    Arena scratch(memory_);
    const Status status = refine(truth::view(patch, pixels), candidate, DetectorOptions{}, scratch, detection);
    EXPECT_EQ(scratch.used(), 0U);
    return status;
  }

  std::vector<std::byte> memory_ = std::vector<std::byte>(refine_scratch_bytes());
};

struct Cell {
  double diameter_px, slant_deg, gradient, noise_grey, blur_px;
};

class RefineAccuracy : public Refine, public testing::WithParamInterface<Cell> {};

TEST_P(RefineAccuracy, SeededPatches_MeetCramerRaoBoundWithHonestCovariance) {
  const Cell cell = GetParam();
  constexpr int kPoses = 8, kNoises = 10;
  Draw draw(17);
  double bound = 0, square = 0, nees = 0, along = 0, across = 0;
  for (int pose = 0; pose < kPoses; ++pose) {
    MarkerPatch patch = patch_of(cell.diameter_px, cell.slant_deg, draw);
    const double azimuth_rad = kPi * draw();
    const Vec2 uphill{std::cos(azimuth_rad), std::sin(azimuth_rad)};
    patch.light_gradient = cell.gradient * uphill;
    patch.paper = 170;  // the gradient's bright side stays below clipping
    patch.noise_grey = cell.noise_grey;
    patch.blur_px = cell.blur_px;
    // The bound hardly depends on the azimuth; two poses are enough and save most of the time.
    if (pose < 2) bound += cramer_rao_bound(patch, truth::Unknown::kRadiiAndBlur).trace() / 2;
    const std::vector<double> clean = render_clean(patch);
    for (int noise = 0; noise < kNoises; ++noise) {
      const auto pixels = truth::digitize(clean, patch.noise_grey, static_cast<uint32_t>(pose * 100 + noise));
      Detection detection;
      ASSERT_TRUE(run(patch, pixels, candidate_of(patch, 0.05, draw), detection).ok());
      ASSERT_EQ(detection.status, DetectionStatus::kOk);
      EXPECT_EQ(detection.rings, 3);
      const Vec2 error = detection.centre_px - patch.centre_px();
      square += error.squaredNorm();
      nees += error.dot(detection.cov_px2.inverse() * error);
      along += error.dot(uphill);
      across += error.dot(Vec2{-uphill.y(), uphill.x()});
    }
  }
  constexpr int kTotal = kPoses * kNoises;
  const double rms_px = std::sqrt(square / kTotal), bound_px = std::sqrt(bound);
  RecordProperty("rms_px", std::to_string(rms_px));
  RecordProperty("bound_px", std::to_string(bound_px));
  EXPECT_LT(rms_px, 1.5 * bound_px);
  EXPECT_GT(rms_px, 0.6 * bound_px) << "better than the bound: the bound or the truth is wrong";
  // The mean over 80 has a standard deviation of rms / sqrt(160) per axis.
  const double mean_limit_px = 0.003 + 3 * bound_px / std::sqrt(2.0 * kTotal);
  EXPECT_LT(std::fabs(along / kTotal), mean_limit_px);
  EXPECT_LT(std::fabs(across / kTotal), mean_limit_px);
  EXPECT_GT(nees / kTotal, 1.0);
  EXPECT_LT(nees / kTotal, 3.5);
}

INSTANTIATE_TEST_SUITE_P(Grid, RefineAccuracy,
                         testing::Values(Cell{20, 0, 0, 2, 0.6}, Cell{20, 45, 0.3, 2, 0.6}, Cell{30, 0, 0.4, 2, 0.8},
                                         Cell{30, 45, 0, 4, 0.8}, Cell{50, 0, 0.4, 1, 0.8}, Cell{50, 45, 0.4, 2, 1.2},
                                         Cell{50, 30, 0.2, 2, 2.0}, Cell{100, 45, 0.4, 2, 0.8}));

TEST_F(Refine, HardSizesAndSlants_StillFound) {
  Draw draw(5);
  for (const Cell& cell : {Cell{15, 0, 0, 2, 0.8}, Cell{15, 45, 0, 2, 0.6}, Cell{30, 70, 0, 2, 0.7},
                           Cell{60, 75, 0.2, 2, 0.8}, Cell{60, 30, 0.2, 2, 3.0}, Cell{500, 20, 0.3, 2, 1.5}}) {
    for (int trial = 0; trial < 6; ++trial) {
      MarkerPatch patch = patch_of(cell.diameter_px, cell.slant_deg, draw);
      patch.blur_px = cell.blur_px;
      patch.light_gradient = {cell.gradient, 0};
      patch.seed = static_cast<uint32_t>(trial + 1);
      Detection detection;
      const Status status = run(patch, render(patch), candidate_of(patch, 0.05, draw), detection);
      ASSERT_TRUE(status.ok()) << status.detail() << " at " << cell.diameter_px << " px, " << cell.slant_deg;
      const Vec2 error = detection.centre_px - patch.centre_px();
      EXPECT_LT(error.dot(detection.cov_px2.inverse() * error), 25) << cell.diameter_px << " px, " << cell.slant_deg;
    }
  }
}

// A marker that fills the view: its circles' centre is a fifth of its size from its ellipse's.
TEST_F(Refine, NearAndSlanted_StillFound) {
  Draw draw(7);
  for (const Cell& cell : {Cell{300, 75, 0.2, 2, 0.8}, Cell{500, 50, 0.2, 2, 0.8}, Cell{900, 45, 0.2, 2, 1.0}}) {
    MarkerPatch patch = patch_of(cell.diameter_px, cell.slant_deg, draw);
    patch.blur_px = cell.blur_px;
    patch.light_gradient = {cell.gradient, 0};
    Detection detection;
    const Status status = run(patch, render(patch), candidate_of(patch, 0.03, draw), detection);
    ASSERT_TRUE(status.ok()) << status.detail() << " at " << cell.diameter_px << " px, " << cell.slant_deg;
    EXPECT_EQ(detection.status, DetectionStatus::kOk) << cell.diameter_px << " px, " << cell.slant_deg;
    const Vec2 error = detection.centre_px - patch.centre_px();
    EXPECT_LT(error.dot(detection.cov_px2.inverse() * error), 25) << cell.diameter_px << " px, " << cell.slant_deg;
  }
}

TEST_F(Refine, OtherRadii_CountedAndMeasured) {
  Draw draw(6);
  const std::vector<std::vector<double>> prints{
      {1, 0.9, 0.8, 0.7, 0.6, 0.5}, {1, 0.8, 0.7, 0.5, 0.4, 0.2}, {1, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3}};
  for (const auto& radii : prints) {
    MarkerPatch patch = patch_of(70, 35, draw);
    patch.radii = radii;
    Detection detection;
    ASSERT_TRUE(run(patch, render(patch), candidate_of(patch, 0.03, draw), detection).ok());
    EXPECT_EQ(detection.rings, static_cast<int>(radii.size() / 2));
    EXPECT_LT((detection.centre_px - patch.centre_px()).norm(), 0.03);
    const Ellipse truth_ellipse = outer_ellipse(patch.H_px_plane);
    EXPECT_NEAR(detection.ellipse.major_px, truth_ellipse.major_px, 0.1);
    EXPECT_NEAR(detection.ellipse.minor_px, truth_ellipse.minor_px, 0.1);
    EXPECT_NEAR(std::sin(detection.ellipse.angle_rad - truth_ellipse.angle_rad), 0, 0.02);
    EXPECT_LT((detection.ellipse.centre_px - truth_ellipse.centre_px).norm(), 0.05);
  }
}

TEST_F(Refine, CandidateIsInnerRing_FindsOuterOne) {
  Draw draw(7);
  MarkerPatch patch = patch_of(80, 30, draw);
  Candidate candidate = candidate_of(patch, 0.0, draw);
  candidate.outer.major_px *= 0.70;
  candidate.outer.minor_px *= 0.70;
  Detection detection;
  ASSERT_TRUE(run(patch, render(patch), candidate, detection).ok());
  EXPECT_EQ(detection.rings, 3);
  EXPECT_NEAR(detection.ellipse.major_px, outer_ellipse(patch.H_px_plane).major_px, 0.2);
}

TEST_F(Refine, ClippedPaper_CentreStaysUnbiased) {
  Draw draw(8);
  Vec2 mean = Vec2::Zero();
  for (int trial = 0; trial < 12; ++trial) {
    MarkerPatch patch = patch_of(50, 30, draw);
    patch.paper = 260;
    patch.light_gradient = {0.3, 0};
    patch.seed = static_cast<uint32_t>(trial + 1);
    Detection detection;
    ASSERT_TRUE(run(patch, render(patch), candidate_of(patch, 0.04, draw), detection).ok());
    mean += (detection.centre_px - patch.centre_px()) / 12;
  }
  EXPECT_LT(mean.norm(), 0.02);
}

TEST_F(Refine, OtherPrints_AreNoMarkers) {
  Draw draw(9);
  struct Other {
    MarkerPatch::Print print;
    std::vector<double> radii;
  };
  const std::vector<Other> others{{MarkerPatch::Print::kRings, {}},
                                  {MarkerPatch::Print::kRings, {1}},
                                  {MarkerPatch::Print::kRings, {1, 0.8}},
                                  {MarkerPatch::Print::kRings, {1, 0.85, 0.7, 0.55}},
                                  {MarkerPatch::Print::kRings, {1, 0.8, 0.6, 0.4}},
                                  {MarkerPatch::Print::kFan, {}},
                                  {MarkerPatch::Print::kCheckerboard, {}},
                                  {MarkerPatch::Print::kText, {}}};
  for (std::size_t i = 0; i < others.size(); ++i) {
    for (const double diameter_px : {14.0, 20.0, 32.0, 60.0, 120.0}) {
      for (const double slant_deg : {0.0, 50.0}) {
        MarkerPatch patch = patch_of(diameter_px, slant_deg, draw);
        patch.print = others[i].print;
        patch.radii = others[i].radii;
        Detection detection;
        EXPECT_FALSE(run(patch, render(patch), candidate_of(patch, 0.05, draw), detection).ok())
            << "print " << i << ", " << diameter_px << " px, slant " << slant_deg;
      }
    }
  }
}

TEST_F(Refine, LightDiscOnDark_IsNoMarker) {
  Draw draw(10);
  MarkerPatch patch = patch_of(50, 20, draw);
  patch.radii = {1};
  patch.paper = 60;
  patch.ink = 250;
  Detection detection;
  EXPECT_EQ(run(patch, render(patch), candidate_of(patch, 0.05, draw), detection).code(), StatusCode::kNotFound);
}

TEST_F(Refine, CutByBorder_SaysSo) {
  Draw draw(11);
  MarkerPatch patch = patch_of(80, 20, draw);
  patch.H_px_plane.row(0) -= 60.0 * patch.H_px_plane.row(2);  // the left third leaves the image
  Detection detection;
  ASSERT_TRUE(run(patch, render(patch), candidate_of(patch, 0.03, draw), detection).ok());
  EXPECT_EQ(detection.status, DetectionStatus::kCutByBorder);
  EXPECT_EQ(detection.rings, 3);
}

TEST_F(Refine, BarInFront_IsNotUsedOrCorrect) {
  Draw draw(12);
  for (const double offset : {0.0, 0.5, 0.8}) {
    MarkerPatch patch = patch_of(80, 20, draw);
    patch.bar_offset_px = patch.centre_px().x() + offset * 40;
    patch.bar_half_px = 7;
    Detection detection;
    if (!run(patch, render(patch), candidate_of(patch, 0.03, draw), detection).ok()) continue;
    if (detection.status == DetectionStatus::kOk) {
      EXPECT_LT((detection.centre_px - patch.centre_px()).norm(), 0.05) << "offset " << offset;
    }
  }
}

TEST_F(Refine, HardShadowEdge_IsNotUsedOrCorrect) {
  Draw draw(13);
  for (const double offset : {-0.6, -0.2, 0.1, 0.5}) {
    MarkerPatch patch = patch_of(70, 20, draw);
    patch.shadow = 0.5;
    patch.shadow_offset_px = patch.centre_px().x() + offset * 35;
    Detection detection;
    if (!run(patch, render(patch), candidate_of(patch, 0.03, draw), detection).ok()) continue;
    if (detection.status == DetectionStatus::kOk) {
      EXPECT_LT((detection.centre_px - patch.centre_px()).norm(), 0.05) << "offset " << offset;
    }
  }
}

TEST_F(Refine, SmallArena_ReportsOutOfMemory) {
  Draw draw(14);
  const MarkerPatch patch = patch_of(40, 20, draw);
  memory_.resize(refine_scratch_bytes() / 2);
  Detection detection;
  EXPECT_EQ(run(patch, render(patch), candidate_of(patch, 0.03, draw), detection).code(), StatusCode::kOutOfMemory);
}

TEST_F(Refine, SenselessCandidate_IsNoMarker) {
  Draw draw(15);
  const MarkerPatch patch = patch_of(40, 20, draw);
  const auto pixels = render(patch);
  Detection detection;
  Candidate nan = candidate_of(patch, 0, draw);
  nan.outer.centre_px.x() = std::nan("");
  EXPECT_EQ(run(patch, pixels, nan, detection).code(), StatusCode::kNotFound);
  Candidate far = candidate_of(patch, 0, draw);
  far.outer.centre_px = {1e6, -1e6};
  EXPECT_EQ(run(patch, pixels, far, detection).code(), StatusCode::kNotFound);
}

}  // namespace
}  // namespace roomcal::marker
