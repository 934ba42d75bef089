#include "drivers/can/standstill.h"

#include <algorithm>
#include <deque>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "tests/drivers/can/vehicle.h"
#include "tests/fakes/fake_can_bus.h"
#include "tests/fakes/manual_clocks.h"

namespace roomcal::drivers {
namespace {

using dbc::veh_motion::ParkBrake;
using dbc::veh_motion::Standstill;
using test::Motion;

constexpr int64_t kMs = 1'000'000;

struct StandstillTest : testing::Test {
  StandstillTest() {
    EXPECT_TRUE(dispatcher.add(sensor).ok());
    dispatcher.poll();
  }

  void say(const Motion& motion = {}) {
    bus.deliver(test::motion_message(motion, counter));
    counter = counter_after(counter);
  }
  // So many messages of a standing vehicle, 20 ms apart, each taken at once.
  void stand(int messages) {
    for (int i = 0; i < messages; ++i) {
      clocks.advance(20 * kMs);
      say();
      dispatcher.poll();
    }
  }
  // The loop goes on, without a message.
  void wait(int64_t ms) {
    for (int64_t done = 0; done < ms; done += 10) {
      clocks.advance(std::min<int64_t>(10, ms - done) * kMs);
      dispatcher.poll();
    }
  }
  bool still() { return sensor.look(clocks.now_ns()).still; }
  std::string why() { return std::string(sensor.look(clocks.now_ns()).why.view()); }
  // One doubtful thing after a long standstill: moving at once, for 150 ms more of good messages, then still again.
  void expect_doubt(Doubt doubt, const char* part) {
    EXPECT_FALSE(still());
    EXPECT_EQ(sensor.doubt(), doubt);
    EXPECT_NE(why().find(part), std::string::npos) << why();
    EXPECT_NE(why().find("can0: "), std::string::npos);
    stand(7);
    EXPECT_FALSE(still());
    stand(2);
    EXPECT_TRUE(still());
  }

  fakes::ManualClocks clocks;
  fakes::FakeCanBus bus{clocks};
  Dispatcher dispatcher{bus, clocks};
  VehicleStandstill sensor{bus, {}};
  uint8_t counter = 0;
};

TEST_F(StandstillTest, NothingHeard_IsMoving) {
  EXPECT_FALSE(still());
  EXPECT_EQ(sensor.doubt(), Doubt::kNothingHeard);
  EXPECT_EQ(why(), "can0: waits for VEH_MOTION; let the vehicle send it");
}

TEST_F(StandstillTest, GoodMessages_AreStillAfterSettling) {
  stand(8);
  EXPECT_FALSE(still());
  stand(1);
  EXPECT_TRUE(still());
  EXPECT_EQ(why(), "");
  stand(100);
  EXPECT_TRUE(still());
}

TEST_F(StandstillTest, SlowestRate_NeedsThreeInARow) {
  for (int i = 0; i < 4; ++i) {
    EXPECT_FALSE(still());
    wait(100);
    say();
    dispatcher.poll();
  }
  EXPECT_TRUE(still());
}

TEST_F(StandstillTest, Silence_IsMovingAfter150Ms) {
  stand(20);
  wait(130);
  EXPECT_TRUE(still());
  wait(1);
  EXPECT_FALSE(still()) << "130 ms and the 20 ms within which the last message came";
  EXPECT_EQ(why(), "can0: VEH_MOTION stays away for 151 ms; check the vehicle's controller and the cable");
  wait(1000);
  expect_doubt(Doubt::kStopped, "stays away for 1151 ms");
}

TEST_F(StandstillTest, SilenceThatNobodyLookedAt_IsNoticedAfterwards) {
  stand(20);
  clocks.advance(500 * kMs);
  say();
  dispatcher.poll();
  EXPECT_FALSE(still());
  EXPECT_EQ(sensor.doubt(), Doubt::kStopped);
}

TEST_F(StandstillTest, HungLoop_DoesNotMakeOldMessagesYoung) {
  stand(20);
  for (int i = 0; i < 15; ++i) {
    clocks.advance(20 * kMs);
    say();
  }
  dispatcher.poll();
  EXPECT_FALSE(still()) << "the newest of them may be 300 ms old";
}

TEST_F(StandstillTest, RepeatedMessage_IsMoving) {
  stand(20);
  counter = static_cast<uint8_t>((counter + kCounterSteps - 1) % kCounterSteps);
  say();
  dispatcher.poll();
  expect_doubt(Doubt::kRepeated, "repeats its counter");
}

TEST_F(StandstillTest, LostMessage_IsMoving) {
  stand(20);
  counter = counter_after(counter);
  say();
  dispatcher.poll();
  expect_doubt(Doubt::kSkipped, "jumps");
}

TEST_F(StandstillTest, DamagedMessage_IsMoving) {
  stand(20);
  ports::CanMessage message = test::motion_message({}, counter);
  message.data[3] ^= 4;
  bus.deliver(message);
  counter = counter_after(counter);
  dispatcher.poll();
  expect_doubt(Doubt::kBadChecksum, "fails its checksum");
}

TEST_F(StandstillTest, ShortMessage_IsMoving) {
  stand(20);
  ports::CanMessage message = test::motion_message({}, counter);
  message.length = 5;
  bus.deliver(message);
  counter = counter_after(counter);
  dispatcher.poll();
  expect_doubt(Doubt::kBadChecksum, "layout");
}

TEST_F(StandstillTest, EveryContentButStandstill_IsMoving) {
  const auto after = [&](const Motion& motion, Doubt doubt, const char* part) {
    stand(20);
    say(motion);
    dispatcher.poll();
    expect_doubt(doubt, part);
  };
  after({.standstill = Standstill::kMoving}, Doubt::kSaysMoving, "stop it");
  after({.standstill = Standstill::kUnknown}, Doubt::kSaysMoving, "does not say");
  after({.standstill = Standstill::kReserved}, Doubt::kSaysMoving, "does not say");
  after({.speed_mps = -0.35}, Doubt::kSpeed, "moves at -0.350 m/s");
  after({.speed_mps = 0.011}, Doubt::kSpeed, "moves at 0.011 m/s");
  after({.yaw_rate_radps = 0.006}, Doubt::kYawRate, "turns at 0.006 rad/s");
}

TEST_F(StandstillTest, UnknownSpeed_IsMovingAndUnmeasuredYawRateIsNot) {
  stand(20);
  ports::CanMessage message = test::motion_message({}, counter);
  put_label(dbc::veh_motion::kYawRate, dbc::veh_motion::YawRate::kNotMeasured, message);
  protect(dbc::veh_motion::kLayout, counter, message);
  counter = counter_after(counter);
  bus.deliver(message);
  dispatcher.poll();
  EXPECT_TRUE(still());
  put_label(dbc::veh_motion::kSpeed, dbc::veh_motion::Speed::kUnknown, message);
  protect(dbc::veh_motion::kLayout, counter, message);
  counter = counter_after(counter);
  bus.deliver(message);
  dispatcher.poll();
  expect_doubt(Doubt::kSpeedUnknown, "does not know its speed");
}

TEST_F(StandstillTest, BusDown_IsMovingUntilItSettles) {
  for (const ports::CanState state : {ports::CanState::kDown, ports::CanState::kBusOff}) {
    stand(20);
    EXPECT_TRUE(still());
    bus.set_state(state);
    clocks.advance(1000 * kMs);
    EXPECT_FALSE(still());
    EXPECT_NE(why().find(to_string(state)), std::string::npos);
    bus.set_state(ports::CanState::kActive);
    EXPECT_FALSE(still());
  }
}

TEST_F(StandstillTest, BusOffThatNobodySaw_IsMoving) {
  stand(20);
  bus.set_state(ports::CanState::kBusOff);
  bus.set_state(ports::CanState::kActive);
  expect_doubt(Doubt::kBusDown, "the bus is or was active");
}

TEST_F(StandstillTest, ErrorPassiveBus_StillCarriesGoodMessages) {
  stand(20);
  bus.set_state(ports::CanState::kPassive);
  stand(1);
  EXPECT_TRUE(still());
}

TEST_F(StandstillTest, ParkBrakeWhereItIsWanted_MustBeApplied) {
  VehicleStandstill strict(bus, {.needs_park_brake = true});
  ASSERT_TRUE(dispatcher.add(strict).ok());
  stand(20);
  EXPECT_TRUE(still());
  EXPECT_FALSE(strict.look(clocks.now_ns()).still);
  EXPECT_EQ(strict.doubt(), Doubt::kParkBrake);
  for (int i = 0; i < 20; ++i) {
    clocks.advance(20 * kMs);
    say({.brake = ParkBrake::kApplied});
    dispatcher.poll();
  }
  EXPECT_TRUE(strict.look(clocks.now_ns()).still);
}

/// A vehicle, a bus and a loop that all fail at random, and what may be believed after everything that came of it.
class Troubled {
 public:
  explicit Troubled(uint64_t seed) : random_(seed) {
    EXPECT_TRUE(dispatcher_.add(sensor_).ok());
    dispatcher_.poll();
  }

  void run(int64_t until_ns) {
    while (clocks_.now_ns() < until_ns) {
      const int64_t wake_ns = clocks_.now_ns() + (one_in(200) ? 300 : 4 + pick(8)) * kMs;
      while (next_message_ns_ <= wake_ns) {
        clocks_.sleep_until(next_message_ns_);
        send();
        next_message_ns_ += (18 + pick(5)) * kMs;
      }
      clocks_.sleep_until(wake_ns);
      change_bus();
      take();
      look();
    }
  }
  int still = 0, looks = 0, faults = 0;

 private:
  struct Seen {
    int64_t sent_ns = 0, taken_ns = 0;
    bool good = false;  ///< checksum and content
    bool whole = false;
    int counter = 0;
  };

  int64_t pick(int64_t below) { return std::uniform_int_distribution<int64_t>(0, below - 1)(random_); }
  bool one_in(int64_t n) { return pick(n) == 0; }

  void send() {
    Seen seen{clocks_.now_ns(), 0, true, true, counter_};
    Motion motion;
    const int64_t fault = one_in(60) || clocks_.now_ns() < trouble_until_ns_ ? pick(8) : -1;
    if (fault >= 0) fault_at_ns_ = clocks_.now_ns();
    faults += fault >= 0;
    if (fault == 0 && one_in(2)) trouble_until_ns_ = clocks_.now_ns() + pick(400) * kMs;
    if (fault == 1) motion.standstill = static_cast<Standstill>(2 * pick(2));
    if (fault == 2) motion.speed_mps = one_in(2) ? 0.2 : -0.02;
    if (fault == 3) seen.counter = counter_ = static_cast<uint8_t>(pick(kCounterSteps));
    if (fault == 4)
      counter_ = static_cast<uint8_t>((counter_ + kCounterSteps - 1) % kCounterSteps), seen.counter = counter_;
    seen.good = fault != 1 && fault != 2;
    ports::CanMessage message = test::motion_message(motion, counter_);
    if (fault == 5) message.data[static_cast<std::size_t>(pick(6))] ^= static_cast<uint8_t>(1 + pick(255));
    if (fault == 5) seen.good = seen.whole = false;
    counter_ = counter_after(counter_);
    if (fault == 6) return;  // lost
    if (fault == 7) next_message_ns_ += pick(400) * kMs;
    bus_.deliver(message);
    waiting_.push_back(seen);
  }

  void change_bus() {
    if (bus_.state() == ports::CanState::kActive && one_in(150))
      bus_.set_state(one_in(2) ? ports::CanState::kDown : ports::CanState::kBusOff);
    else if (bus_.state() != ports::CanState::kActive && one_in(10))
      bus_.set_state(ports::CanState::kActive);
    if (bus_.state() != ports::CanState::kActive) bus_down_ns_ = fault_at_ns_ = clocks_.now_ns();
  }

  void take() {
    dispatcher_.poll();
    for (Seen& seen : waiting_) {
      seen.taken_ns = clocks_.now_ns();
      if (seen.taken_ns - seen.sent_ns > 15 * kMs) fault_at_ns_ = clocks_.now_ns();  // the loop hung
      history_.push_back(seen);
    }
    waiting_.clear();
    while (history_.size() > 64) history_.pop_front();
  }

  // Everything by which the specification forbids to believe in standstill, from the true times.
  void expect_allowed(int64_t now_ns) const {
    ASSERT_GE(history_.size(), 4U);
    ASSERT_GE(now_ns - bus_down_ns_, 150 * kMs) << "the bus was down";
    ASSERT_LE(now_ns - history_.back().sent_ns, 150 * kMs) << "the newest message is too old";
    int in_a_row = 0;
    for (std::size_t i = history_.size(); i-- > 1;) {
      const Seen &seen = history_[i], &before = history_[i - 1];
      if (in_a_row++ >= 3 && now_ns - seen.taken_ns >= 150 * kMs) return;
      ASSERT_TRUE(seen.good && seen.whole) << "a bad one " << (now_ns - seen.taken_ns) / kMs << " ms ago";
      if (before.whole) {
        ASSERT_EQ(seen.counter, counter_after(static_cast<uint8_t>(before.counter)));
      }
      ASSERT_LE(seen.sent_ns - before.sent_ns, 150 * kMs) << "silence";
    }
  }

  void look() {
    ++looks;
    const ports::Stillness stillness = sensor_.look(clocks_.now_ns());
    ASSERT_EQ(stillness.still, stillness.why.empty());
    if (stillness.still) expect_allowed(clocks_.now_ns());
    const bool quiet = clocks_.now_ns() - fault_at_ns_ > 700 * kMs && clocks_.now_ns() > 3'000 * kMs;
    if (quiet) {
      ASSERT_TRUE(stillness.still) << stillness.why.view() << " at " << clocks_.now_ns();
    }
    still += stillness.still;
  }

  std::mt19937_64 random_;
  fakes::ManualClocks clocks_;
  fakes::FakeCanBus bus_{clocks_};
  Dispatcher dispatcher_{bus_, clocks_};
  VehicleStandstill sensor_{bus_, {}};
  uint8_t counter_ = 0;
  int64_t next_message_ns_ = 0, trouble_until_ns_ = 0, fault_at_ns_ = 0, bus_down_ns_ = 0;
  std::deque<Seen> waiting_, history_;
};

TEST(StandstillModel, RandomFaults_NeverStillWithin150MsOfADoubt) {
  int still = 0, looks = 0, faults = 0;
  for (uint64_t seed = 0; seed < 300; ++seed) {
    Troubled world(seed);
    world.run(30'000 * kMs);
    ASSERT_FALSE(testing::Test::HasFatalFailure()) << "seed " << seed;
    still += world.still;
    looks += world.looks;
    faults += world.faults;
  }
  std::printf("%d looks, %d still, %d faults\n", looks, still, faults);
  EXPECT_GT(still, looks / 20) << "a sensor that never says still proves nothing";
  EXPECT_GT(faults, 5000);
}

}  // namespace
}  // namespace roomcal::drivers
