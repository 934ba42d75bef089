#include "runtime/rig/joint_problem.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/runtime/rig/shot.h"

namespace roomcal::rig {
namespace {

struct Fixture {
  explicit Fixture(const test::ShotOptions& options) : memory(4U << 20U), arena(memory) {
    truth::Random random(41);
    shot = test::make_shot(random, truth::make_room(random), options);
    EXPECT_TRUE(JointProblem::build({shot.views(), {}, kNoReference, shot.landmarks}, {}, arena, problem).ok());
  }
  std::vector<std::byte> memory;
  Arena arena;
  test::Shot shot;
  JointProblem problem;
};

TEST(JointProblem, Layout_HoldsEveryObservationOnceByViewAndByLandmark) {
  Fixture f({});
  ASSERT_EQ(f.problem.terms.size(), f.shot.observation_count());
  std::vector<int> times(f.problem.terms.size(), 0);
  for (std::size_t l = 0; l < f.problem.landmarks.size(); ++l) {
    const LandmarkTerms& landmark = f.problem.landmarks[l];
    for (const uint32_t i : f.problem.by_landmark.subspan(landmark.first, landmark.count)) {
      EXPECT_EQ(f.problem.terms[i].landmark, l);
      ++times[i];
    }
  }
  for (const int count : times) EXPECT_EQ(count, 1);
  for (std::size_t v = 0; v < f.problem.views.size(); ++v)
    for (const Term& term : f.problem.terms.subspan(f.problem.views[v].first, f.problem.views[v].count))
      EXPECT_EQ(term.view, v);
}

TEST(JointProblem, TurnOver_FollowsTheResidualsDownAndStopsAtTheScale) {
  test::ShotOptions options;
  options.start_sigma_m = options.start_sigma_rad = 0.05;
  Fixture f(options);
  f.problem.linearize();
  f.problem.update_turn_over();
  std::vector<double> wide;
  for (std::size_t v = 0; v < 4; ++v) {
    wide.push_back(f.problem.views[v].turn_over);
    EXPECT_GT(wide[v], 30) << "the start is centimetres off";
    f.problem.state.T_room_sensor[v] = f.shot.T_room_cam[v];
  }
  f.problem.linearize();
  f.problem.update_turn_over();
  for (std::size_t v = 0; v < 4; ++v) EXPECT_NEAR(f.problem.views[v].turn_over, 3, 0.7);
  for (std::size_t v = 0; v < 4; ++v) f.problem.state.T_room_sensor[v] = f.shot.start_T_room_cam[v];
  f.problem.linearize();
  f.problem.update_turn_over();
  for (std::size_t v = 0; v < 4; ++v) EXPECT_LT(f.problem.views[v].turn_over, 4) << "never raised again";
}

TEST(JointProblem, PointOutsideTheField_CostsTheBoundAndPullsNowhere) {
  test::ShotOptions options;
  options.start_sigma_m = options.start_sigma_rad = 0;
  Fixture f(options);
  f.problem.linearize();
  f.problem.update_turn_over();
  const double before = f.problem.reweight();
  const Term& term = f.problem.terms.front();
  const RedescendingLoss loss(f.problem.views[0].turn_over);
  const double own = loss(term.r.squaredNorm()).loss;
  f.problem.landmarks[term.landmark].prior_room = f.shot.T_room_cam[0] * Vec3(0, 0, -1);
  const uint32_t others = f.problem.landmarks[term.landmark].count;
  ASSERT_EQ(others, 1U);
  f.problem.linearize();
  EXPECT_NEAR(f.problem.reweight(), before - own + loss.max_loss(), 1e-9 * before);
  EXPECT_EQ(f.problem.terms.front().weight, 0);
  EXPECT_NEAR(f.problem.cost(f.problem.state), before - own + loss.max_loss(), 1e-9 * before);
}

}  // namespace
}  // namespace roomcal::rig
