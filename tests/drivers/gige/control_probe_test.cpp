#include "drivers/gige/control_probe.h"

#include <thread>

#include <gtest/gtest.h>

#include "drivers/gige/gvcp.h"
#include "tests/drivers/gige/udp_peer.h"

namespace roomcal::drivers {
namespace {

constexpr int64_t kMs = 1'000'000;

ControlState probe_answered(uint16_t status, const std::vector<std::byte>& value, int unanswered = 0) {
  UdpPeer camera;
  std::thread answers([&] {
    for (int i = 0; i < unanswered; ++i) camera.receive();
    const std::vector<std::byte> command = camera.receive();
    if (!command.empty()) camera.answer(acknowledge(command, status, value));
  });
  const ControlState state = probe_control(camera.endpoint(), LinuxClocks(), 3, 200 * kMs);
  answers.join();
  return state;
}

std::vector<std::byte> register_value(uint8_t low) { return {{}, {}, {}, static_cast<std::byte>(low)}; }

TEST(ControlProbe, CameraThatSomebodyControls_SaysSo) {
  EXPECT_EQ(probe_answered(gvcp::kSuccess, register_value(2)), ControlState::kControlled);
  EXPECT_EQ(probe_answered(gvcp::kSuccess, register_value(1)), ControlState::kControlled);
  EXPECT_EQ(probe_answered(gvcp::kAccessDenied, {}), ControlState::kControlled);
}

TEST(ControlProbe, CameraThatHasRestarted_IsFree) {
  EXPECT_EQ(probe_answered(gvcp::kSuccess, register_value(0)), ControlState::kFree);
}

TEST(ControlProbe, LostDatagram_IsSentAgain) {
  EXPECT_EQ(probe_answered(gvcp::kSuccess, register_value(2), 2), ControlState::kControlled);
}

TEST(ControlProbe, NoAnswer_IsAbsentAfterTheTries) {
  UdpPeer silent;
  const LinuxClocks clocks;
  const int64_t began_ns = clocks.now_ns();
  EXPECT_EQ(probe_control(silent.endpoint(), clocks, 3, 20 * kMs), ControlState::kAbsent);
  EXPECT_GE(clocks.now_ns() - began_ns, 60 * kMs);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(silent.receive(kMs).size(), 12U);
}

TEST(ControlProbe, NoRoute_IsAbsent) {
  const sockaddr_in nowhere{};  // address family 0
  EXPECT_EQ(probe_control(nowhere, LinuxClocks(), 1, kMs), ControlState::kAbsent);
}

}  // namespace
}  // namespace roomcal::drivers
