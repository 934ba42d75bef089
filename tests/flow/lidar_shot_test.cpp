// Shots of the robot with two LiDARs at the level of observations: rings with their noise, sweeps of a simulated room.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/calib/to_record.h"
#include "tests/budget/heap_guard.h"
#include "tools/evaluate/trust_trial.h"
#include "tools/simulate/random_stream.h"

namespace roomcal::flow {
namespace {

using namespace tools;

class LidarShot : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    room_ = new TrustRoom(1);
    device_ = new TrustDevice(make_trust_device(*room_, 3));
    T_room_rig_ = place_trust_device(*room_, 4);
    session_ = new TrustSession(device_->device, room_->data());
  }
  static void TearDownTestSuite() {
    delete session_;
    delete device_;
    delete room_;
  }
  static TrustShot take(const TrustFlaws& flaws = {}) {
    Random random = random_stream(5, 1);
    return take_trust_shot(*room_, *device_, T_room_rig_, flaws, random);
  }

  static TrustRoom* room_;
  static TrustDevice* device_;
  static TrustSession* session_;
  static SE3 T_room_rig_;
};
TrustRoom* LidarShot::room_ = nullptr;
TrustDevice* LidarShot::device_ = nullptr;
TrustSession* LidarShot::session_ = nullptr;
SE3 LidarShot::T_room_rig_;

TEST_F(LidarShot, Clean_MeetsTheTruthWithLidarsInThePairs) {
  TrustShot shot = take();
  const calib::Outcome& outcome = session_->run(shot, nullptr);
  ASSERT_TRUE(calib::may_write(outcome.verdict)) << outcome.reasons[0].view();
  ASSERT_EQ(calib::located_sensors(outcome).size(), 6U);
  for (std::size_t i = 0; i < 2; ++i) {
    const Vec6 error = se3_log(outcome.lidars[i].T_rig_lidar.inverse() * device_->T_rig_sensor[4 + i]);
    EXPECT_LT(error.head<3>().norm(), 0.003);
    EXPECT_LT(error.tail<3>().norm(), deg_to_rad(0.05));
  }
  EXPECT_NEAR(outcome.held_out.median_sigmas, 1, 0.4);
}

TEST_F(LidarShot, ComputingIt_CallsNoHeap) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer brings its own allocator";
#endif
  TrustShot shot = take();
  const TrustShotView view(shot);
  Status status;
  std::size_t calls = 0;
  {
    const budget::HeapGuard guard;
    status = session_->calibrate(view.shot(), nullptr);
    calls = guard.calls();
  }
  ASSERT_TRUE(status.ok());
  EXPECT_EQ(calls, 0U);
}

class StopAt final : public calib::Observer {
 public:
  explicit StopAt(std::size_t step) : step_(step) {}
  bool on_step(const calib::Progress& progress) override {
    total_ = progress.total;
    return progress.done != step_;
  }
  std::size_t total() const { return total_; }

 private:
  std::size_t step_;
  std::size_t total_ = 0;
};

TEST_F(LidarShot, StoppedBeforeAnyStep_WritesNothingAndTheNextShotIsAsEver) {
  TrustShot shot = take();
  const Mat44 T_rig_lidar = session_->run(shot, nullptr).lidars[1].T_rig_lidar.matrix();
  constexpr std::size_t kSteps = 4 + 2 + 2;  // cameras and LiDARs located, refined, judged
  for (std::size_t step = 0; step < kSteps; ++step) {
    StopAt observer(step);
    const TrustShotView view(shot);
    EXPECT_EQ(session_->calibrate(view.shot(), nullptr, &observer).code(), StatusCode::kCancelled);
    EXPECT_EQ(observer.total(), kSteps);
    EXPECT_FALSE(calib::may_write(session_->outcome().verdict));
    for (const calib::LocatedSensor& sensor : calib::located_sensors(session_->outcome())) EXPECT_FALSE(sensor.in_rig);
    store::Record record;
    EXPECT_FALSE(calib::to_record(session_->outcome(), device_->device, {}, record).ok());
  }
  StopAt never(kSteps);
  const TrustShotView view(shot);
  ASSERT_TRUE(session_->calibrate(view.shot(), nullptr, &never).ok());
  EXPECT_EQ(session_->outcome().lidars[1].T_rig_lidar.matrix(), T_rig_lidar);
}

TEST_F(LidarShot, LidarWithoutSweeps_IsRefusedByNameAndTheOtherIsLocated) {
  TrustShot shot = take();
  shot.sweeps[0].points.clear();
  const calib::Outcome& outcome = session_->run(shot, nullptr);
  EXPECT_FALSE(calib::may_write(outcome.verdict));
  EXPECT_NE(std::string(outcome.reasons[0].view()).find("lidar0: only 0 returns"), std::string::npos);
  EXPECT_FALSE(outcome.lidars[0].located);
  EXPECT_TRUE(outcome.lidars[1].in_rig);
}

TEST_F(LidarShot, NoCameraAtAll_StillTellsWhereTheLidarsAreButNoRig) {
  TrustShot shot = take();
  for (auto& rings : shot.rings) rings.clear();
  const calib::Outcome& outcome = session_->run(shot, nullptr);
  EXPECT_FALSE(calib::may_write(outcome.verdict));
  for (const calib::LidarOutcome& lidar : outcome.lidars) EXPECT_FALSE(lidar.in_rig);
}

TEST(Trust, AFewShots_NameWhatMoved) {
  const TrustRoom room(1);
  MoveTally moves;
  for (uint64_t seed = 1; seed <= 4; ++seed) run_move_trial(room, seed, {}, moves);
  EXPECT_EQ(moves.false_alarms, 0);
  EXPECT_EQ(moves.named, moves.moved - moves.unseen);
  EXPECT_GE(moves.named, 3);
}

}  // namespace
}  // namespace roomcal::flow
