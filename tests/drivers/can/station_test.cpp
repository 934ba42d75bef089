#include "drivers/can/station.h"

#include <set>

#include <gtest/gtest.h>

#include "drivers/can/protection.h"
#include "tests/fakes/fake_can_bus.h"
#include "tests/fakes/manual_clocks.h"

namespace roomcal::drivers {
namespace {

namespace status = dbc::cal_status;
using dbc::cal_cmd::Command;
using status::CommandAnswer;

constexpr int64_t kMs = 1'000'000;

struct StationTest : testing::Test {
  StationTest() {
    EXPECT_TRUE(dispatcher.add(station).ok());
    dispatcher.poll();
  }

  // The device's loop for so long, at 100 Hz.
  void run(int64_t for_ns) {
    for (const int64_t end_ns = clocks.now_ns() + for_ns; clocks.now_ns() < end_ns; clocks.advance(10 * kMs)) {
      dispatcher.poll();
      station.poll();
    }
  }
  std::vector<ports::CanMessage> sent(const MessageLayout& layout) const {
    std::vector<ports::CanMessage> found;
    for (const ports::CanMessage& message : bus.sent())
      if (is_of(layout, message)) found.push_back(message);
    return found;
  }
  ports::CanMessage last_status() const { return sent(status::kLayout).back(); }
  uint32_t nonce() const { return static_cast<uint32_t>(raw_of(status::kNonce, last_status())); }
  CommandAnswer answer() {
    run(110 * kMs);
    return static_cast<CommandAnswer>(raw_of(status::kCommandAnswer, last_status()));
  }
  ports::CanMessage command(int64_t number, uint32_t with_nonce, uint8_t counter = 0) {
    ports::CanMessage message = blank(dbc::cal_cmd::kLayout);
    put_raw(dbc::cal_cmd::kCommand, number, message);
    put_raw(dbc::cal_cmd::kNonce, with_nonce, message);
    protect(dbc::cal_cmd::kLayout, counter, message);
    return message;
  }
  ports::CanMessage command(Command wanted, uint32_t with_nonce, uint8_t counter = 0) {
    return command(static_cast<int64_t>(wanted), with_nonce, counter);
  }
  void hear(const ports::CanMessage& message) {
    bus.deliver(message);
    dispatcher.poll();
  }
  int take_all() {
    int taken = 0;
    for (CalCommand ignored; station.next_command(ignored);) ++taken;
    return taken;
  }

  fakes::ManualClocks clocks;
  fakes::FakeCanBus bus{clocks};
  Dispatcher dispatcher{bus, clocks};
  Station station{bus, clocks, 1234};
};

TEST_F(StationTest, Status_ComesTenTimesASecondWithRunningCounter) {
  station.set_status({status::State::kCalibrating, status::Step::kSolve, 71.9, status::Reason::kMoving, true,
                      status::Store::kFactory});
  run(3'000 * kMs);
  const auto messages = sent(status::kLayout);
  ASSERT_EQ(messages.size(), 30U);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    EXPECT_EQ(check_protection(status::kLayout, messages[i]), Protection::kGood);
    EXPECT_EQ(counter_of(messages[i]), i % 15);
  }
  EXPECT_EQ(raw_of(status::kState, messages[9]), static_cast<int64_t>(status::State::kCalibrating));
  EXPECT_EQ(raw_of(status::kStep, messages[9]), static_cast<int64_t>(status::Step::kSolve));
  EXPECT_EQ(value_of(status::kProgress, messages[9]), 71) << "100 only when it is over";
  EXPECT_EQ(raw_of(status::kReason, messages[9]), static_cast<int64_t>(status::Reason::kMoving));
  EXPECT_EQ(raw_of(status::kStationary, messages[9]), 1);
  EXPECT_EQ(raw_of(status::kStore, messages[9]), static_cast<int64_t>(status::Store::kFactory));
  EXPECT_EQ(station.counters().status_sent, 30U);
}

TEST_F(StationTest, HungLoop_SendsNoStatus) {
  run(1'000 * kMs);
  bus.forget_sent();
  clocks.advance(60'000 * kMs);
  EXPECT_TRUE(bus.sent().empty());
  run(300 * kMs);
  EXPECT_EQ(sent(status::kLayout).size(), 3U) << "what was missed is not made up for";
}

TEST_F(StationTest, BusThatRefuses_IsCountedAndPasses) {
  run(100 * kMs);
  bus.set_state(ports::CanState::kBusOff);
  run(1'000 * kMs);
  EXPECT_EQ(station.counters().status_refused, 10U);
  bus.set_state(ports::CanState::kActive);
  run(100 * kMs);
  EXPECT_EQ(station.counters().status_sent, 2U);
}

TEST_F(StationTest, FreshCommand_IsTakenOnce) {
  run(200 * kMs);
  const uint32_t fresh = nonce();
  hear(command(Command::kCalibrate, fresh));
  CalCommand got;
  ASSERT_TRUE(station.next_command(got));
  EXPECT_EQ(got.command, Command::kCalibrate);
  EXPECT_EQ(got.arrival.latest_ns, clocks.now_ns());
  EXPECT_FALSE(station.next_command(got));
  EXPECT_EQ(answer(), CommandAnswer::kTaken);
  EXPECT_NE(nonce(), fresh);
  // Repetitions by a careful sender do nothing, and do not spoil the answer.
  for (uint8_t counter = 1; counter < 5; ++counter) hear(command(Command::kCalibrate, fresh, counter));
  EXPECT_EQ(take_all(), 0);
  EXPECT_EQ(station.counters().repeated, 4U);
  EXPECT_EQ(answer(), CommandAnswer::kTaken);
}

TEST_F(StationTest, EveryCommandHeardBefore_FindsTheDoorClosed) {
  std::vector<ports::CanMessage> recording;
  for (int i = 0; i < 50; ++i) {
    run(110 * kMs);
    recording.push_back(command(i % 2 == 0 ? Command::kVerify : Command::kAbort, nonce()));
    hear(recording.back());
    EXPECT_EQ(take_all(), 1);
  }
  for (int round = 0; round < 3; ++round) {
    for (const ports::CanMessage& message : recording) hear(message);
    run(1'000 * kMs);
  }
  EXPECT_EQ(take_all(), 0);
  Station restarted(bus, clocks, 1235);
  ASSERT_TRUE(dispatcher.add(restarted).ok());
  for (const ports::CanMessage& message : recording) hear(message);
  CalCommand got;
  EXPECT_FALSE(restarted.next_command(got));
}

TEST_F(StationTest, CommandsThatNobodyFetches_AreRefusedNotLost) {
  for (int i = 0; i < 6; ++i) {
    run(110 * kMs);
    hear(command(Command::kVerify, nonce()));
  }
  EXPECT_EQ(answer(), CommandAnswer::kBusy);
  EXPECT_EQ(station.counters().crowded_out, 2U);
  EXPECT_EQ(take_all(), 4);
  hear(command(Command::kVerify, nonce()));
  EXPECT_EQ(take_all(), 1) << "what was refused may be sent again";
}

TEST_F(StationTest, UndeliveredCommand_IsStaleAfterTwoSeconds) {
  run(150 * kMs);
  const ports::CanMessage early = command(Command::kCalibrate, nonce());
  run(1'000 * kMs);
  EXPECT_NE(nonce(), static_cast<uint32_t>(raw_of(dbc::cal_cmd::kNonce, early)));
  run(1'100 * kMs);
  hear(early);
  EXPECT_EQ(take_all(), 0);
  EXPECT_EQ(answer(), CommandAnswer::kStaleNonce);
}

TEST_F(StationTest, NonceOfTheStatusBefore_IsStillGood) {
  run(900 * kMs);
  const uint32_t before = nonce();
  run(300 * kMs);
  ASSERT_NE(nonce(), before);
  hear(command(Command::kAbort, before));
  EXPECT_EQ(take_all(), 1);
}

TEST_F(StationTest, Nonces_DoNotRepeat) {
  std::set<uint32_t> seen;
  for (int second = 0; second < 3'000; ++second) {
    run(110 * kMs);
    EXPECT_TRUE(seen.insert(nonce()).second) << second;
    clocks.advance(900 * kMs);
  }
}

TEST_F(StationTest, DamagedOrUnknownCommands_DoNothing) {
  run(150 * kMs);
  const ports::CanMessage good = command(Command::kCalibrate, nonce());
  for (unsigned bit = 0; bit < 40; ++bit) {
    ports::CanMessage damaged = good;
    damaged.data[bit / 8] ^= static_cast<uint8_t>(1U << bit % 8);
    hear(damaged);
  }
  EXPECT_EQ(station.counters().damaged, 40U);
  hear(command(9, nonce()));
  EXPECT_EQ(answer(), CommandAnswer::kUnknownCommand);
  hear(command(Command::kNone, nonce()));
  EXPECT_EQ(take_all(), 0);
  hear(good);
  EXPECT_EQ(take_all(), 1) << "nothing of it used the nonce up";
}

TEST_F(StationTest, AnswerOfTheBoard_IsTold) {
  station.answer(CommandAnswer::kNotPermitted);
  EXPECT_EQ(answer(), CommandAnswer::kNotPermitted);
}

TEST_F(StationTest, Result_IsSentUntilItWasOnTheBus) {
  namespace result = dbc::cal_result;
  bus.refuse = 1;
  station.announce({false, Verdict::kPassAdvise, false, 5, 6, 0.1234, 0x1234567890AB});
  EXPECT_TRUE(sent(result::kLayout).empty());
  run(1'000 * kMs);
  const auto messages = sent(result::kLayout);
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(check_protection(result::kLayout, messages[0]), Protection::kGood);
  EXPECT_EQ(raw_of(result::kVerdict, messages[0]), static_cast<int64_t>(result::Verdict::kPassAdvise));
  EXPECT_EQ(raw_of(result::kKind, messages[0]), static_cast<int64_t>(result::Kind::kCalibrate));
  EXPECT_EQ(raw_of(result::kSensorsDone, messages[0]), 5);
  EXPECT_EQ(raw_of(result::kSensorsWanted, messages[0]), 6);
  EXPECT_NEAR(value_of(result::kRms, messages[0]), 0.123, 1e-9);
  EXPECT_EQ(raw_of(result::kGeneration, messages[0]), 0x7890AB);
  EXPECT_EQ(station.counters().results_sent, 1U);
}

TEST_F(StationTest, ResultThatNobodyConfirms_IsGivenUpAndCounted) {
  bus.confirms = false;
  station.announce({.aborted = true, .rms_px = 1e9});
  run(7'000 * kMs);
  const auto messages = sent(dbc::cal_result::kLayout);
  EXPECT_EQ(messages.size(), 50U);
  EXPECT_EQ(raw_of(dbc::cal_result::kVerdict, messages[0]), static_cast<int64_t>(dbc::cal_result::Verdict::kAborted));
  EXPECT_EQ(value_of(dbc::cal_result::kRms, messages[0]), 16.383) << "the largest value stands for more";
  EXPECT_EQ(station.counters().results_given_up, 1U);
}

TEST_F(StationTest, Trigger_TellsWhenItWasOnTheBus) {
  TriggerMark mark;
  EXPECT_FALSE(station.last_fired(mark));
  bus.send_delay_ns = 137'000;
  const int64_t fired_ns = clocks.now_ns();
  ASSERT_TRUE(station.fire().ok());
  ASSERT_TRUE(station.fire().ok());
  const Stamp on_bus{clocks.read(ClockId::kRealtime).ns + 137'000, ClockId::kRealtime};
  dispatcher.poll();
  ASSERT_TRUE(station.last_fired(mark));
  EXPECT_EQ(mark.id, 1);
  EXPECT_NEAR(mark.sender_s, static_cast<double>(fired_ns) * 1e-9, 1e-6);
  EXPECT_EQ(mark.on_bus, on_bus);
  EXPECT_STREQ(station.name(), "CAN");
}

TEST_F(StationTest, TriggerThatIsRefused_KeepsItsNumber) {
  bus.refuse = 1;
  EXPECT_EQ(station.fire().code(), StatusCode::kUnavailable);
  ASSERT_TRUE(station.fire().ok());
  dispatcher.poll();
  TriggerMark mark;
  ASSERT_TRUE(station.last_fired(mark));
  EXPECT_EQ(mark.id, 0);
}

TEST_F(StationTest, MarksOfOthers_ComeWithBothStamps) {
  namespace in = dbc::cal_trigger_in;
  ports::CanMessage message = blank(in::kLayout);
  put_raw(in::kTriggerId, 200, message);
  put_clamped(in::kStamp, 17'592'186.0, message);
  protect(in::kLayout, 0, message);
  for (int i = 0; i < 20; ++i) hear(message);
  message.data[2] ^= 1;
  hear(message);
  TriggerMark mark;
  for (int i = 0; i < 16; ++i) ASSERT_TRUE(station.next_mark(mark));
  EXPECT_FALSE(station.next_mark(mark));
  EXPECT_EQ(mark.id, 200);
  EXPECT_NEAR(mark.sender_s, 17'592'186.0, 1e-6);
  EXPECT_EQ(mark.on_bus, clocks.read(ClockId::kRealtime));
  EXPECT_EQ(station.counters().crowded_out, 4U);
  EXPECT_EQ(station.counters().damaged, 1U);
}

}  // namespace
}  // namespace roomcal::drivers
