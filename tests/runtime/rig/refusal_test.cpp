#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "tests/runtime/rig/shot.h"

namespace roomcal::rig {
namespace {

using test::Shot;
using test::ShotOptions;
using test::Solver;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Shot good_shot(uint64_t seed, double map_sigma_m = 0) {
  truth::Random random(seed);
  const auto room = truth::make_room(random);
  ShotOptions options;
  options.map_cov_m2 = map_sigma_m * map_sigma_m * Mat33::Identity();
  return test::make_shot(random, room, options);
}

// Replaces what camera 2 sees by markers along one line in front of it.
void line_up(Shot& shot, truth::Random& random, double map_sigma_m) {
  auto& seen = shot.observations[2];
  seen.clear();
  for (int i = 0; i < 12; ++i) {
    const Vec3 p_cam{-1.0 + 0.17 * i, 0.3 + 0.05 * i, 2.0 + 0.03 * i};
    Vec3 p_room = shot.T_room_cam[2] * p_cam;
    const Mat33 cov_m2 = map_sigma_m * map_sigma_m * Mat33::Identity();
    Vec2 px;
    ASSERT_TRUE(shot.device[2].camera.project(p_cam, px).ok());
    if (map_sigma_m > 0) p_room += truth::draw(random, cov_m2);
    const Mat22 cov_px2 = 0.01 * Mat22::Identity();
    seen.push_back({px + truth::draw(random, cov_px2), cov_px2, static_cast<uint16_t>(shot.landmarks.size())});
    shot.landmarks.push_back({p_room, cov_m2});
  }
}

void expect_degenerate_view_2(const Shot& shot, const char* what) {
  Solver solver;
  const Status status = solver.solve(shot);
  EXPECT_EQ(status.code(), StatusCode::kDegenerate) << what << ": " << status.detail();
  EXPECT_EQ(solver.degenerate_view, 2U) << what;
  EXPECT_NE(std::strstr(status.detail(), "more markers"), nullptr);
  EXPECT_TRUE(solver.solution.T_room_sensor.empty());
}

TEST(Refusal, CameraWithFewObservations_IsDegenerate) {
  for (const double map_sigma_m : {0.0, 0.005}) {
    for (std::size_t count = 0; count <= 2; ++count) {
      Shot shot = good_shot(21, map_sigma_m);
      shot.observations[2].resize(count);
      expect_degenerate_view_2(shot, "few observations");
    }
  }
}

TEST(Refusal, CollinearMarkers_AreDegenerate) {
  truth::Random random(22);
  for (const double map_sigma_m : {0.0, 1e-4, 1e-3, 0.005}) {
    Shot shot = good_shot(22, map_sigma_m);
    line_up(shot, random, map_sigma_m);
    expect_degenerate_view_2(shot, "collinear");
  }
}

TEST(Refusal, AllObservationsIdentical_IsDegenerate) {
  for (const double map_sigma_m : {0.0, 0.005}) {
    Shot shot = good_shot(23, map_sigma_m);
    for (RingObservation& observation : shot.observations[2]) observation = shot.observations[2].front();
    expect_degenerate_view_2(shot, "identical");
  }
}

TEST(Refusal, NothingLooksIntoTheCamera_IsDegenerate) {
  Shot shot = good_shot(24);
  shot.start_T_room_cam[2] = {shot.T_room_cam[2].R, {1e3, 1e3, 1e3}};
  Solver solver;
  EXPECT_FALSE(solver.solve(shot).ok());
}

TEST(Refusal, ObservationsOfRandomPixels_NeverPassWithGoodChi2) {
  truth::Random random(25);
  for (int i = 0; i < 50; ++i) {
    Shot shot = good_shot(25);
    for (RingObservation& observation : shot.observations[1])
      observation.centre_px = {random.uniform(0, 1280), random.uniform(0, 720)};
    Solver solver;
    if (!solver.solve(shot).ok()) continue;
    EXPECT_GT(solver.solution.chi2, 20 * solver.solution.degrees_of_freedom);
  }
}

void expect_code(StatusCode code, const std::function<void(Shot&, SolveOptions&)>& spoil, const char* what) {
  Shot shot = good_shot(26, 0.001);
  SolveOptions options;
  spoil(shot, options);
  Solver solver;
  EXPECT_EQ(solver.solve(shot, options).code(), code) << what;
  EXPECT_TRUE(solver.solution.T_room_sensor.empty()) << what;
}

TEST(Refusal, BadNumbers_AreInvalid) {
  const StatusCode invalid = StatusCode::kInvalidArgument;
  expect_code(
      invalid, [](Shot& s, SolveOptions&) { s.observations[0][3].centre_px.x() = kNaN; }, "centre");
  expect_code(
      invalid, [](Shot& s, SolveOptions&) { s.observations[0][3].cov_px2(0, 1) = kNaN; }, "covariance");
  expect_code(
      invalid, [](Shot& s, SolveOptions&) { s.observations[0][3].cov_px2.setZero(); }, "no covariance");
  expect_code(
      invalid, [](Shot& s, SolveOptions&) { s.observations[0][3].landmark = 60000; }, "landmark number");
  expect_code(
      invalid, [](Shot& s, SolveOptions&) { s.landmarks[5].p_room.z() = kNaN; }, "landmark");
  expect_code(
      invalid, [](Shot& s, SolveOptions&) { s.landmarks[5].cov_m2(1, 1) = -1; }, "landmark covariance");
  expect_code(
      invalid, [](Shot& s, SolveOptions&) { s.start_T_room_cam[1].t.x() = kNaN; }, "start position");
  expect_code(
      invalid, [](Shot& s, SolveOptions&) { s.start_T_room_cam[1].R *= 1.1; }, "start rotation");
  expect_code(
      invalid, [](Shot& s, SolveOptions&) { s.start_T_room_cam[1].R *= -1; }, "mirrored start");
  expect_code(
      invalid, [](Shot&, SolveOptions& o) { o.robust_scale = kNaN; }, "scale");
  expect_code(
      invalid, [](Shot&, SolveOptions& o) { o.sigma_floor_px = -1; }, "floor");
  expect_code(
      invalid, [](Shot&, SolveOptions& o) { o.max_iterations = 0; }, "iterations");
}

TEST(Refusal, NoCamerasOrTooMany_IsSaid) {
  Solver solver;
  const Shot shot = good_shot(27);
  EXPECT_EQ(solver.solve({}, shot.landmarks).code(), StatusCode::kInvalidArgument);
  std::vector<CameraView> many(kMaxViews + 1, shot.views()[0]);
  EXPECT_EQ(solver.solve(many, shot.landmarks).code(), StatusCode::kCapacity);
  std::vector<CameraView> blind = shot.views();
  blind[0].camera = nullptr;
  EXPECT_EQ(solver.solve(blind, shot.landmarks).code(), StatusCode::kInvalidArgument);
}

TEST(Refusal, TooFewRounds_IsNotConverged) {
  Shot shot = good_shot(28);
  SolveOptions options;
  options.max_iterations = 1;
  Solver solver;
  EXPECT_EQ(solver.solve(shot, options).code(), StatusCode::kNotConverged);
}

// Every byte count below the need refuses cleanly: the arena that is full at the n-th request, for every n.
TEST(Refusal, ArenaFullAtEveryRequest_IsOutOfMemory) {
  const Shot shot = good_shot(29, 0.001);
  const auto views = shot.views();
  const std::size_t need_scratch = solve_scratch_bytes(views.size(), shot.observation_count(), shot.landmarks.size());
  const std::size_t need_step = solve_step_bytes(views.size());
  std::vector<std::byte> scratch_bytes(need_scratch), step_bytes(need_step);
  RigSolution solution;
  const auto solve_with = [&](std::size_t scratch_size, std::size_t step_size) {
    Arena scratch(std::span<std::byte>(scratch_bytes).first(scratch_size)),
        step(std::span<std::byte>(step_bytes).first(step_size));
    const Status status = solve_cameras(views, shot.landmarks, {}, step, scratch, solution);
    EXPECT_EQ(scratch.used(), 0U);
    return status;
  };
  for (std::size_t part = 0; part < 64; ++part) {
    EXPECT_EQ(solve_with(need_scratch * part / 66, need_step).code(), StatusCode::kOutOfMemory) << part;
    EXPECT_EQ(solve_with(need_scratch, need_step * part / 66).code(), StatusCode::kOutOfMemory) << part;
    EXPECT_TRUE(solution.T_room_sensor.empty());
  }
  EXPECT_TRUE(solve_with(need_scratch, need_step).ok());
}

}  // namespace
}  // namespace roomcal::rig
