#include "drivers/gige/control_probe.h"

#include <array>
#include <optional>

#include "drivers/gige/gvcp.h"
#include "drivers/gige/ipv4.h"
#include "drivers/os/wait.h"

namespace roomcal::drivers {

namespace {

constexpr uint32_t kPrivileges = 0x3;

std::optional<gvcp::Acknowledgement> ask(int socket, const sockaddr_in& camera, uint16_t id, const ports::Clock& clock,
                                         int64_t wait_ns) {
  if (!send_datagram(socket, camera, gvcp::read_register(id, gvcp::kControlRegister).span())) return std::nullopt;
  const int64_t deadline_ns = clock.now_ns() + wait_ns;
  const std::array<int, 1> fds{socket};
  while (clock.now_ns() < deadline_ns && wait_readable(fds, deadline_ns) != 0) {
    std::array<std::byte, 64> bytes;
    const auto ack = gvcp::parse_acknowledgement(receive_datagram(socket, bytes), gvcp::Answer::kReadRegister);
    if (ack && ack->id == id) return ack;
  }
  return std::nullopt;
}

}  // namespace

const char* to_string(ControlState state) {
  switch (state) {
    case ControlState::kAbsent:
      return "absent";
    case ControlState::kFree:
      return "free";
    case ControlState::kControlled:
      return "controlled";
  }
  return "unknown";
}

ControlState probe_control(const sockaddr_in& camera, const ports::Clock& clock, int tries, int64_t wait_ns) {
  const Result<UniqueFd> socket = open_udp_socket("");
  if (!socket.ok()) return ControlState::kAbsent;
  for (int i = 1; i <= tries; ++i) {
    const auto ack = ask(socket.value().get(), camera, static_cast<uint16_t>(i), clock, wait_ns);
    if (!ack) continue;
    // A camera that somebody controls exclusively denies even to read.
    const bool held = ack->status == gvcp::kAccessDenied || (ack->value & kPrivileges) != 0;
    return held ? ControlState::kControlled : ControlState::kFree;
  }
  return ControlState::kAbsent;
}

}  // namespace roomcal::drivers
