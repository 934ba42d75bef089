#include "drivers/gige/action_trigger.h"

#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "tests/budget/heap_guard.h"
#include "tests/drivers/gige/udp_peer.h"
#include "tests/fakes/log_lines.h"

namespace roomcal::drivers {
namespace {

// The host's clocks, except that its atomic time is as a test says.
struct SetClocks final : ports::SystemClocks {
  int64_t now_ns() const override { return LinuxClocks().now_ns(); }
  Stamp read(ClockId clock) const override { return {clock == ClockId::kTai ? tai_ns : 0, clock}; }
  void sleep_until(int64_t deadline_ns) const override { LinuxClocks().sleep_until(deadline_ns); }
  int64_t tai_ns = 0;
};

class ActionTriggerTest : public testing::Test {
 protected:
  ActionOptions options_for(const UdpPeer& peer) {
    ActionOptions options;
    options.address = "127.0.0.1";
    options.port = peer.port();
    options.device_key = 1;
    options.group_key = 2;
    options.group_mask = 4;
    return options;
  }

  SetClocks clocks_;
  fakes::LogLines log_;
};

gvcp::ActionCommand expected(uint16_t id) {
  gvcp::ActionCommand command;
  command.id = id;
  command.device_key = 1;
  command.group_key = 2;
  command.group_mask = 4;
  return command;
}

std::vector<std::byte> bytes_of(const gvcp::ActionCommand& command) {
  const gvcp::Datagram datagram = gvcp::action_command(command);
  return {datagram.begin(), datagram.end()};
}

TEST_F(ActionTriggerTest, Fire_SendsOneDatagramEachTime) {
  UdpPeer camera;
  ActionTrigger trigger(options_for(camera), clocks_, log_);
  ASSERT_TRUE(trigger.open().ok());
  ASSERT_TRUE(trigger.fire().ok());
  ASSERT_TRUE(trigger.fire().ok());
  EXPECT_EQ(camera.receive(), bytes_of(expected(1)));
  EXPECT_EQ(camera.receive(), bytes_of(expected(2)));
  EXPECT_TRUE(camera.receive(50'000'000).empty());
  EXPECT_EQ(trigger.counters().sent, 2U);
}

TEST_F(ActionTriggerTest, Lead_SchedulesOnTheCamerasClock) {
  UdpPeer camera;
  clocks_.tai_ns = 1'700'000'037'000'000'000;
  ActionOptions options = options_for(camera);
  options.lead_ns = 5'000'000;
  ActionTrigger trigger(options, clocks_, log_);
  ASSERT_TRUE(trigger.open().ok());
  ASSERT_TRUE(trigger.fire().ok());
  gvcp::ActionCommand command = expected(1);
  command.action_time = 1'700'000'037'005'000'000;
  EXPECT_EQ(camera.receive(), bytes_of(command));
  EXPECT_EQ(trigger.action_time(), (Stamp{1'700'000'037'005'000'000, ClockId::kTai}));
}

TEST_F(ActionTriggerTest, HostWithoutTheCamerasClock_SendsNothing) {
  UdpPeer camera;
  ActionOptions options = options_for(camera);
  options.lead_ns = 5'000'000;
  ActionTrigger trigger(options, clocks_, log_);
  ASSERT_TRUE(trigger.open().ok());
  EXPECT_EQ(trigger.fire().code(), StatusCode::kUnavailable);
  EXPECT_TRUE(camera.receive(50'000'000).empty());
}

TEST_F(ActionTriggerTest, Broadcast_ReachesEveryCamera) {
  UdpPeer one("127.255.255.255");
  UdpPeer other("127.255.255.255", one.port());
  ActionOptions options = options_for(one);
  options.address = "127.255.255.255";
  options.local_address = "127.0.0.1";
  ActionTrigger trigger(options, clocks_, log_);
  ASSERT_TRUE(trigger.open().ok());
  ASSERT_TRUE(trigger.fire().ok());
  EXPECT_EQ(one.receive(), bytes_of(expected(1)));
  EXPECT_EQ(other.receive(), bytes_of(expected(1)));
}

TEST_F(ActionTriggerTest, Acknowledgements_AreCountedByWhatTheySay) {
  UdpPeer camera;
  ActionOptions options = options_for(camera);
  options.expected_acknowledgements = 3;
  options.acknowledgement_wait_ns = 200'000'000;
  ActionTrigger trigger(options, clocks_, log_);
  ASSERT_TRUE(trigger.open().ok());
  std::thread answers([&] {
    const std::vector<std::byte> command = camera.receive();
    ASSERT_FALSE(command.empty());
    std::vector<std::byte> of_another = acknowledge(command, gvcp::kSuccess);
    of_another[7] = std::byte{0x77};
    camera.answer(of_another);
    camera.answer(acknowledge(command, gvcp::kSuccess));
    camera.answer(acknowledge(command, gvcp::kActionLate));
  });
  EXPECT_TRUE(trigger.fire().ok());
  answers.join();
  EXPECT_EQ(trigger.counters().acknowledged, 1U);
  EXPECT_EQ(trigger.counters().refused, 1U);
  EXPECT_EQ(trigger.counters().late, 1U);
  EXPECT_EQ(trigger.counters().missing, 1U);
  EXPECT_EQ(log_.count("too late; lengthen the lead"), 1U);
}

TEST_F(ActionTriggerTest, FloodOfForeignDatagrams_DoesNotHoldItUp) {
  UdpPeer camera;
  ActionOptions options = options_for(camera);
  options.expected_acknowledgements = 1;
  options.acknowledgement_wait_ns = 50'000'000;
  ActionTrigger trigger(options, clocks_, log_);
  ASSERT_TRUE(trigger.open().ok());
  std::atomic<bool> over{false};
  std::thread flood([&] {
    if (camera.receive().empty()) return;
    while (!over) camera.answer(std::array{std::byte{0}});
  });
  const int64_t began_ns = clocks_.now_ns();
  EXPECT_TRUE(trigger.fire().ok());
  EXPECT_LT(clocks_.now_ns() - began_ns, 1'000'000'000);
  over = true;
  flood.join();
  EXPECT_EQ(trigger.counters().missing, 1U);
}

TEST_F(ActionTriggerTest, Ids_SkipZero) {
  UdpPeer camera;
  ActionTrigger trigger(options_for(camera), clocks_, log_);
  ASSERT_TRUE(trigger.open().ok());
  for (int i = 0; i < 0x10000; ++i) {
    ASSERT_TRUE(trigger.fire().ok());
    const std::vector<std::byte> command = camera.receive();
    ASSERT_EQ(command.size(), 20U);
    ASSERT_FALSE(command[6] == std::byte{0} && command[7] == std::byte{0}) << i;
  }
}

TEST_F(ActionTriggerTest, BadOptions_AreNamed) {
  UdpPeer camera;
  ActionOptions options = options_for(camera);
  options.address = "camera";
  EXPECT_EQ(ActionTrigger(options, clocks_, log_).open().code(), StatusCode::kInvalidArgument);
  options = options_for(camera);
  options.local_address = "192.0.2.77";
  EXPECT_EQ(ActionTrigger(options, clocks_, log_).open().code(), StatusCode::kUnavailable);
  options = options_for(camera);
  options.lead_ns = 1;
  options.cameras_clock = ClockId::kMonotonic;
  EXPECT_EQ(ActionTrigger(options, clocks_, log_).open().code(), StatusCode::kInvalidArgument);
}

TEST_F(ActionTriggerTest, NotOpen_IsUnavailable) {
  UdpPeer camera;
  ActionTrigger trigger(options_for(camera), clocks_, log_);
  EXPECT_EQ(trigger.fire().code(), StatusCode::kUnavailable);
  EXPECT_EQ(trigger.counters().not_sent, 1U);
}

TEST_F(ActionTriggerTest, Fire_TakesNoHeap) {
  UdpPeer camera;
  ActionOptions options = options_for(camera);
  options.expected_acknowledgements = 1;
  options.acknowledgement_wait_ns = 1'000'000;
  ActionTrigger trigger(options, clocks_, log_);
  ASSERT_TRUE(trigger.open().ok());
  budget::HeapGuard guard;
  const Status fired = trigger.fire();
  EXPECT_EQ(guard.calls(), 0U);
  EXPECT_TRUE(fired.ok());
}

}  // namespace
}  // namespace roomcal::drivers
