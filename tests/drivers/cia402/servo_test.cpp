#include "drivers/cia402/servo.h"

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "tests/drivers/cia402/servo_bench.h"

namespace roomcal::drivers::cia402 {
namespace {

using test::kMs;
using test::ServoBench;

std::string reason_of(const Servo& servo) { return std::string(servo.reason().view()); }

TEST(Servo, PowerOn_HomesAndIsReady) {
  ServoBench bench;
  bench.servo.power_on();
  ASSERT_TRUE(bench.reach(ServoStep::kReady)) << reason_of(bench.servo);
  EXPECT_EQ(bench.drive.homed_at(), 1);
  EXPECT_NEAR(bench.drive.position_counts(), 0, 1);
  EXPECT_TRUE(bench.drive.enabled());
  EXPECT_EQ(reason_of(bench.servo), "");
  bench.run(2'000);
  EXPECT_TRUE(bench.servo.ready());
  EXPECT_FALSE(bench.drive.missed_master());
}

TEST(Servo, AbsoluteEncoder_NeedsNoHoming) {
  ServoBench bench({.node_id = 5});
  bench.drive.trouble.modes = 0x04;
  bench.servo.power_on();
  ASSERT_TRUE(bench.reach(ServoStep::kReady)) << reason_of(bench.servo);
  EXPECT_EQ(bench.drive.homed_at(), 0);
}

TEST(Servo, Turn_RampsHoldsAndStops) {
  ServoBench bench;
  EXPECT_EQ(bench.servo.turn(1).code(), StatusCode::kUnavailable);
  ASSERT_TRUE(bench.reach_any(ServoStep::kTurn));
  EXPECT_EQ(bench.servo.turn(std::numeric_limits<double>::quiet_NaN()).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(bench.servo.turn(-3.3).code(), StatusCode::kInvalidArgument);
  EXPECT_FALSE(bench.servo.at_speed());
  bench.run(1'500);
  EXPECT_TRUE(bench.servo.at_speed());
  EXPECT_NEAR(angle_of(bench.options, bench.drive.velocity_counts()), 1.0, 1e-5);
  bench.servo.stop();
  ASSERT_TRUE(bench.reach(ServoStep::kReady));
  EXPECT_EQ(bench.drive.velocity_counts(), 0);
  EXPECT_TRUE(bench.drive.enabled()) << "holds its place";
}

// The point of it all: whatever delays SYNC and answer, a position is true at its stamp.
TEST(Servo, PositionsOfADelayedSync_AreTrueAtTheirStamps) {
  ServoBench bench;
  std::mt19937 random(7);
  bench.before_each = [&] { bench.bus.send_delay_ns = std::uniform_int_distribution<int64_t>(0, 900'000)(random); };
  ASSERT_TRUE(bench.reach_any(ServoStep::kTurn));
  bench.positions.clear();
  const uint64_t unanswered = bench.servo.sync_counters().unanswered;
  bench.run(7'000);
  ASSERT_GT(bench.positions.size(), 690U);
  const auto& truth = bench.drive.latched();
  std::size_t next = 0;
  for (const ServoPosition& position : bench.positions) {
    while (next < truth.size() && truth[next].first != position.on_bus.ns) ++next;
    ASSERT_LT(next, truth.size()) << "a stamp of no SYNC";
    ASSERT_LE(std::abs(static_cast<double>(position.counts) - truth[next].second), 0.5 + 1e-6);
    ASSERT_NEAR(position.angle_rad, angle_of(bench.options, truth[next].second), 1e-5);
  }
  EXPECT_EQ(bench.servo.sync_counters().unanswered, unanswered);
}

TEST(Servo, CounterOverItsEnd_GoesOn) {
  ServoBench bench({.node_id = 5, .counts_per_turn = 6e8});
  ASSERT_TRUE(bench.reach_any(ServoStep::kTurn)) << reason_of(bench.servo);
  bench.run(30'000);
  ASSERT_GT(bench.drive.position_counts(), 2.5e9);
  EXPECT_NEAR(static_cast<double>(bench.positions.back().counts), bench.drive.position_counts(), 2e6);
  for (std::size_t i = 1; i < bench.positions.size(); ++i)
    ASSERT_GE(bench.positions[i].counts, bench.positions[i - 1].counts);
}

TEST(Servo, LateOrDoubleAnswers_GiveNoWrongPosition) {
  ServoBench bench;
  ASSERT_TRUE(bench.reach_any(ServoStep::kTurn));
  bench.run(1'500);
  const std::size_t before = bench.positions.size();
  bench.drive.trouble.double_tpdo = true;
  bench.run(200);
  EXPECT_EQ(bench.positions.size(), before + 20) << "the first of two";
  EXPECT_GE(bench.servo.sync_counters().unasked, 20U);
  bench.drive.trouble.double_tpdo = false;
  bench.drive.send_statusword_late(6 * kMs);
  bench.run(200);
  EXPECT_EQ(bench.positions.size(), before + 20) << "later than half a period is nobody's";
}

TEST(Servo, PositionsThatNobodyFetches_LeaveAGapNotAnError) {
  ServoBench bench;
  ASSERT_TRUE(bench.reach_any(ServoStep::kReady));
  bench.positions.clear();
  for (int i = 0; i < 3'000; ++i) {
    bench.clocks.advance(kMs);
    bench.drive.tick();
    bench.dispatcher.poll();
    bench.servo.poll();
  }
  bench.turn_once();
  EXPECT_EQ(bench.positions.size(), 100U);
  EXPECT_TRUE(bench.servo.ready());
}

TEST(Servo, FaultAtTheStart_IsReset) {
  ServoBench bench;
  bench.drive.trouble.faulty = true;
  bench.servo.power_on();
  EXPECT_TRUE(bench.reach(ServoStep::kReady)) << reason_of(bench.servo);
}

TEST(Servo, LostAnswers_AreAskedForAgain) {
  ServoBench bench;
  bench.drive.trouble.lose_sdo = 2;
  bench.servo.power_on();
  EXPECT_TRUE(bench.reach(ServoStep::kReady)) << reason_of(bench.servo);
}

TEST(Servo, DriveThatIsPoweredLater_IsWaitedFor) {
  ServoBench bench;
  bench.drive.trouble.mute = true;
  bench.servo.power_on();
  bench.run(3'000);
  bench.drive.trouble.mute = false;
  EXPECT_TRUE(bench.reach(ServoStep::kReady)) << reason_of(bench.servo);
}

TEST(Servo, OptionalObjectsThatAreMissing_DoNotMatter) {
  for (const uint16_t index : {0x1016, 0x6007, 0x1005, 0x6085, 0x609A}) {
    ServoBench bench;
    bench.drive.trouble.refuse_index = index;
    bench.drive.trouble.refuse_code = kAbortNoObject;
    bench.servo.power_on();
    EXPECT_TRUE(bench.reach(ServoStep::kReady)) << std::hex << index << " " << reason_of(bench.servo);
  }
}

TEST(Servo, OurProgramDies_TheDriveStopsByItself) {
  ServoBench bench;
  ASSERT_TRUE(bench.reach_any(ServoStep::kTurn));
  bench.run(1'500);
  for (int i = 0; i < 3'000; ++i) {
    bench.clocks.advance(kMs);
    bench.drive.tick();
  }
  EXPECT_TRUE(bench.drive.missed_master());
  EXPECT_EQ(bench.drive.velocity_counts(), 0);
}

TEST(Servo, PowerOff_StopsFirstAndLeavesTheNodeAlone) {
  for (const ServoStep step : {ServoStep::kReset, ServoStep::kConfigure, ServoStep::kHome, ServoStep::kReady,
                               ServoStep::kTurn, ServoStep::kStop, ServoStep::kFaulted}) {
    SCOPED_TRACE(to_string(step));
    ServoBench bench;
    if (step == ServoStep::kFaulted) {
      ASSERT_TRUE(bench.reach_any(ServoStep::kTurn));
      bench.drive.emergency(0x4310);
    } else {
      ASSERT_TRUE(bench.reach_any(step));
    }
    bench.run(20);
    bench.servo.power_off();
    ASSERT_TRUE(bench.reach(ServoStep::kOff, 8'000));
    EXPECT_FALSE(bench.drive.enabled());
    bench.bus.forget_sent();
    bench.run(2'000);
    EXPECT_TRUE(bench.bus.sent().empty());
    bench.servo.power_on();
    EXPECT_TRUE(bench.reach(ServoStep::kReady));
  }
}

TEST(Servo, PowerOffWithoutABus_EndsAllTheSame) {
  ServoBench bench;
  ASSERT_TRUE(bench.reach_any(ServoStep::kTurn));
  bench.bus.set_state(ports::CanState::kBusOff);
  bench.servo.power_off();
  EXPECT_TRUE(bench.reach(ServoStep::kOff, 8'000));
}

struct Mishap {
  const char* name;
  std::function<void(ServoBench&)> happens;
  ServoStep first, last;  ///< steps that it must end
  ServoFault fault;
  const char* part;  ///< of the reason
};

const std::vector<Mishap>& mishaps() {
  using S = ServoStep;
  using F = ServoFault;
  static const std::vector<Mishap> all{
      {"cable cut", [](ServoBench& b) { b.drive.trouble.mute = true; }, S::kReset, S::kReset, F::kNoBoot, "power"},
      {"cable cut", [](ServoBench& b) { b.drive.trouble.mute = true; }, S::kIdentify, S::kConfigure, F::kSdoTimeout,
       "object "},
      {"cable cut", [](ServoBench& b) { b.drive.trouble.mute = true; }, S::kStart, S::kStop, F::kHeartbeatLost,
       "heartbeat lost; check its cable"},
      {"bus-off", [](ServoBench& b) { b.bus.set_state(ports::CanState::kBusOff); }, S::kReset, S::kStop, F::kBusDown,
       "wiring"},
      {"bus down", [](ServoBench& b) { b.bus.set_state(ports::CanState::kDown); }, S::kReset, S::kStop, F::kBusDown,
       "interface"},
      {"no heartbeat", [](ServoBench& b) { b.drive.trouble.no_heartbeat = true; }, S::kStart, S::kStop,
       F::kHeartbeatLost, "heartbeat lost"},
      {"reboot", [](ServoBench& b) { b.drive.reboot(); }, S::kIdentify, S::kStop, F::kRebooted, "power supply"},
      {"no SDO", [](ServoBench& b) { b.drive.trouble.no_sdo = true; }, S::kIdentify, S::kConfigure, F::kSdoTimeout,
       "object "},
      {"no SDO", [](ServoBench& b) { b.drive.trouble.no_sdo = true; }, S::kSelectHoming, S::kSelectHoming,
       F::kSdoTimeout, "6060h"},
      {"SDO abort", [](ServoBench& b) { b.drive.trouble.refuse_index = 0x6060; }, S::kSelectHoming, S::kSelectHoming,
       F::kSdoAbort, "(object 6060h sub 0: not in its present state)"},
      {"SDO abort", [](ServoBench& b) { b.drive.trouble.refuse_index = 0x1A00; }, S::kConfigure, S::kConfigure,
       F::kSdoAbort, "1A00h"},
      {"other device", [](ServoBench& b) { b.drive.trouble.device_type = 0x00020191; }, S::kReset, S::kReset,
       F::kNotADrive, "node id"},
      {"no homing", [](ServoBench& b) { b.drive.trouble.modes = 0x05; }, S::kReset, S::kReset, F::kNoSuchMode,
       "another drive"},
      {"no start", [](ServoBench& b) { b.drive.trouble.ignores_start = true; }, S::kConfigure, S::kConfigure,
       F::kNotStarted, "starting"},
      {"no position", [](ServoBench& b) { b.drive.trouble.no_tpdo = true; }, S::kConfigure, S::kStop, F::kNoPosition,
       "SYNC"},
      {"SYNC not confirmed", [](ServoBench& b) { b.bus.confirms = false; }, S::kStart, S::kStop, F::kSyncLost,
       "acknowledges"},
      {"SYNC refused", [](ServoBench& b) { b.bus.refuse = 1'000'000; }, S::kStart, S::kReady, F::kSyncLost, "bus load"},
      {"other master", [](ServoBench& b) { b.drive.leave_operational(); }, S::kEnable, S::kStop, F::kLeftOperation,
       "master"},
      {"cannot be enabled", [](ServoBench& b) { b.drive.trouble.stuck_disabled = true; }, S::kReset, S::kStart,
       F::kNotEnabled, "(switch-on disabled)"},
      {"fault that stays",
       [](ServoBench& b) {
         b.drive.trouble.fault_stays = true;
         b.drive.break_down(0x3220);
       },
       S::kEnable, S::kEnable, F::kDriveFault, "3220h: voltage"},
      {"emergency stop", [](ServoBench& b) { b.drive.lose_enable(); }, S::kSelectHoming, S::kStop, F::kDisabled,
       "emergency stop"},
      {"emergency", [](ServoBench& b) { b.drive.emergency(0x4310); }, S::kSelectHoming, S::kStop, F::kEmergency,
       "(emergency 4310h: temperature)"},
      {"following error", [](ServoBench& b) { b.drive.break_down(0x8611); }, S::kSelectHoming, S::kStop,
       F::kFollowingError, "turns freely"},
      {"slips", [](ServoBench& b) { b.drive.trouble.slips = true; }, S::kTurn, S::kStop, F::kFollowingError,
       "following error"},
      {"mode refused", [](ServoBench& b) { b.drive.trouble.mode_stays = true; }, S::kSelectHoming, S::kSelectHoming,
       F::kModeRefused, "mode"},
      {"homing fails", [](ServoBench& b) { b.drive.trouble.homing_fails = true; }, S::kReset, S::kHome,
       F::kHomingFailed, "home switch"},
      {"homing hangs", [](ServoBench& b) { b.drive.trouble.homing_hangs = true; }, S::kReset, S::kHome,
       F::kHomingTimeout, "homing does not end"},
      {"never stops", [](ServoBench& b) { b.drive.trouble.never_stands = true; }, S::kStop, S::kStop, F::kNotStopped,
       "emergency stop"},
  };
  return all;
}

// What happens at every step from `first` to `last`: a named fault, the drive told to stop, and a second life.
TEST(ServoFaults, EveryMishapAtEveryStep_IsNamedStopsTheTurnAndCanBeCured) {
  int cases = 0;
  for (const Mishap& mishap : mishaps()) {
    for (int i = static_cast<int>(mishap.first); i <= static_cast<int>(mishap.last); ++i) {
      const auto step = static_cast<ServoStep>(i);
      SCOPED_TRACE(std::string(mishap.name) + " while " + to_string(step));
      ServoBench bench({.node_id = 5, .homing_method = 17, .homing_timeout_ns = 10'000 * kMs});
      ASSERT_TRUE(bench.reach_any(step));
      if (step == ServoStep::kTurn) bench.run(700);
      mishap.happens(bench);
      const bool moved = bench.drive.velocity_counts() != 0;
      bench.bus.forget_sent();
      ASSERT_TRUE(bench.reach(ServoStep::kFaulted, 25'000));
      EXPECT_EQ(to_string(bench.servo.fault().fault), std::string(to_string(mishap.fault)));
      EXPECT_NE(reason_of(bench.servo).find("servo node 5, "), std::string::npos);
      EXPECT_NE(reason_of(bench.servo).find(mishap.part), std::string::npos) << reason_of(bench.servo);
      bench.bus.set_state(ports::CanState::kActive);
      bench.bus.confirms = true;
      bench.bus.refuse = 0;
      bench.drive.trouble = {};
      bench.run(2'500);
      EXPECT_EQ(bench.servo.step(), ServoStep::kFaulted) << "it does not start by itself";
      if (moved) {
        EXPECT_EQ(bench.drive.velocity_counts(), 0);
      }
      EXPECT_EQ(bench.servo.turn(1).code(), StatusCode::kUnavailable);
      bench.servo.power_on();
      EXPECT_TRUE(bench.reach(ServoStep::kReady)) << reason_of(bench.servo);
      ++cases;
    }
  }
  std::printf("%d cases\n", cases);
}

TEST(ServoFaults, FaultWhileTurning_QuickStopsAtEverySync) {
  ServoBench bench;
  ASSERT_TRUE(bench.reach_any(ServoStep::kTurn));
  bench.run(1'500);
  bench.drive.emergency(0x7305);
  bench.run(20);
  EXPECT_TRUE(bench.drive.told_to_stop());
  EXPECT_EQ(reason_of(bench.servo),
            "servo node 5, turning: emergency (emergency 7305h: encoder 1); look it up in the drive's manual");
  bench.bus.forget_sent();
  bench.run(1'000);
  int commands = 0;
  for (const auto& message : bench.bus.sent())
    if (message.id == rpdo1_id(5)) {
      ++commands;
      EXPECT_EQ(message.data[0], 0x02);
      EXPECT_EQ(le(message.bytes().subspan(2, 4)), 0U);
    }
  EXPECT_EQ(commands, 100);
}

TEST(ServoFaults, EmergencyThatIsOver_IsNoFault) {
  ServoBench bench;
  ASSERT_TRUE(bench.reach_any(ServoStep::kTurn));
  bench.drive.emergency(0);
  bench.run(100);
  EXPECT_EQ(bench.servo.step(), ServoStep::kTurn);
}

TEST(ServoFaults, EveryFaultAndStep_HasAName) {
  for (int i = 0; i < static_cast<int>(ServoFault::kCount); ++i)
    EXPECT_GT(std::string(to_string(static_cast<ServoFault>(i))).size(), 3U);
  for (int i = 0; i < static_cast<int>(ServoStep::kCount); ++i)
    EXPECT_GT(std::string(to_string(static_cast<ServoStep>(i))).size(), 2U);
  EXPECT_TRUE(explain(5, {}).empty());
}

}  // namespace
}  // namespace roomcal::drivers::cia402
