#include "tools/join/join_shots.h"

#include <memory>

#include <gtest/gtest.h>

#include "tools/common/error.h"
#include "tools/evaluate/trust_join.h"
#include "tools/simulate/random_stream.h"

namespace roomcal::tools {
namespace {

class JoinShots : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    room_ = new TrustRoom(1);
    device_ = new TrustDevice(make_trust_device(*room_, 3));
    session_ = new TrustSession(device_->device, room_->data());
  }
  static void TearDownTestSuite() {
    delete session_;
    delete device_;
    delete room_;
  }

  static TrustShot take(uint64_t place) {
    Random random = random_stream(place, 1);
    return take_trust_shot(*room_, *device_, place_trust_device(*room_, place), {}, random);
  }
  static const calib::Outcome& run(TrustShot& shot) { return session_->run(shot, nullptr); }
  static Vec6 error_of(const calib::CameraOutcome& camera, std::size_t number) {
    return se3_log(camera.T_rig_cam.inverse() * device_->T_rig_sensor[number]);
  }

  static TrustRoom* room_;
  static TrustDevice* device_;
  static TrustSession* session_;
};
TrustRoom* JoinShots::room_ = nullptr;
TrustDevice* JoinShots::device_ = nullptr;
TrustSession* JoinShots::session_ = nullptr;

TEST_F(JoinShots, CamerasBlindInOneShotEach_AreAllThereInTheJoinedOne) {
  TrustShot without_1 = take(4), without_2 = take(5);
  without_1.rings[1].clear();
  without_2.rings[2].clear();
  ShotJoiner joiner(session_->session());
  for (TrustShot* shot : {&without_1, &without_2}) {
    const calib::Outcome& alone = run(*shot);
    EXPECT_FALSE(calib::may_write(alone.verdict));
    joiner.add("shot", alone);
  }
  const calib::Outcome& joined = joiner.join();
  ASSERT_TRUE(calib::may_write(joined.verdict)) << joined.reasons[0].view();
  ASSERT_EQ(calib::located_sensors(joined).size(), 6U);
  for (const std::size_t number : {1U, 2U, 3U}) {
    const Vec6 error = error_of(joined.cameras[number], number);
    EXPECT_LT(error.head<3>().norm(), 0.0005);
    EXPECT_LT(error.tail<3>().norm(), deg_to_rad(0.02));
  }
  const rig::RelativePose pair =
      rig::relative_pose(joined.solution, joined.cameras[joined.reference].view, joined.cameras[3].view);
  EXPECT_LT(se3_log(pair.T_a_b.inverse() * joined.cameras[3].T_rig_cam).norm(), 1e-12);
  EXPECT_LT((pair.cov - joined.cameras[3].cov_rig_cam).norm(), 1e-6 * pair.cov.norm());
}

TEST_F(JoinShots, OneShot_IsThatShot) {
  TrustShot shot = take(6);
  const auto alone = std::make_unique<calib::Outcome>(run(shot));
  ShotJoiner joiner(session_->session());
  joiner.add("only", *alone);
  const Mat66 cov = alone->cameras[2].cov_rig_cam;
  const calib::Outcome& joined = joiner.join();
  EXPECT_EQ(joined.verdict, alone->verdict);
  for (const std::size_t i : {1U, 2U, 3U})
    EXPECT_LT(se3_log(joined.cameras[i].T_rig_cam.inverse() * alone->cameras[i].T_rig_cam).norm(), 1e-6);
  EXPECT_LT((joined.cameras[2].cov_rig_cam - cov).norm(), 0.01 * cov.norm());
  EXPECT_EQ(joined.lidars[0].location.weak.size(), alone->lidars[0].location.weak.size());
}

TEST_F(JoinShots, SensorMovedBetweenShots_IsNamed) {
  TrustShot before = take(7), after;
  const SE3 was = device_->T_rig_sensor[2];
  ShotJoiner joiner(session_->session());
  joiner.add("before", run(before));
  device_->T_rig_sensor[2] = was * SE3{Mat33::Identity(), Vec3(0.005, 0, 0)};
  after = take(8);
  device_->T_rig_sensor[2] = was;
  joiner.add("after", run(after));
  const calib::Outcome& joined = joiner.join();
  EXPECT_EQ(joined.verdict, calib::Verdict::kFailService);
  bool named = false;
  for (const Reason& reason : joined.reasons)
    named = named || reason.view().starts_with(std::string(device_->name(2)) + ": is not in the same place");
  EXPECT_TRUE(named);
}

TEST_F(JoinShots, NothingLocated_IsARefusalAndNoShotsAnError) {
  TrustShot dark = take(9);
  for (auto& rings : dark.rings) rings.clear();
  for (auto& sweep : dark.sweeps) sweep = {};
  ShotJoiner joiner(session_->session());
  EXPECT_THROW(joiner.join(), ToolError);
  joiner.add("dark", run(dark));
  EXPECT_FALSE(calib::may_write(joiner.join().verdict));
}

TEST(TrustJoin, FewShots_AreMoreCertainThanOneAndSayNoMoreThanTheyKnow) {
  const TrustRoom room(2);
  for (const bool refine : {false, true}) {
    JoinTally tally;
    tally.shots_each = 2;
    TrustDeviceOptions options;
    options.refine_intrinsics = refine;
    for (uint64_t seed = 1; seed <= 2; ++seed) run_join_trial(room, seed, options, tally);
    EXPECT_EQ(tally.joined_passed, tally.trials);
    EXPECT_EQ(tally.false_alarms, 0);
    for (const PairKind kind : kPairKinds) {
      const PairTally &alone = tally.alone[static_cast<std::size_t>(kind)],
                      &joined = tally.joined[static_cast<std::size_t>(kind)];
      EXPECT_LT(joined.sigma_m(), 0.9 * alone.sigma_m()) << to_string(kind);
      EXPECT_LT(joined.rms_m(), 2 * joined.sigma_m()) << to_string(kind);
    }
  }
}

}  // namespace
}  // namespace roomcal::tools
