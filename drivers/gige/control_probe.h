#pragma once

#include <cstdint>

#include <netinet/in.h>

#include "runtime/ports/clock.h"

namespace roomcal::drivers {

enum class ControlState : uint8_t {
  kAbsent,      ///< no answer: unplugged, without power, hung
  kFree,        ///< it is there and nobody controls it: it has restarted, or its heartbeat ran out
  kControlled,  ///< it is there, and somebody controls it
};
/// "absent", "free", "controlled".
const char* to_string(ControlState state);

/// Asks a GigE Vision camera for its control register, without being or becoming its controller. Aravis takes 2.5 s for
/// a read that nobody answers; this takes `tries` times `wait_ns`.
/// @param camera  address and port (gvcp::kPort).
/// @return kAbsent also if the datagram cannot be sent. No heap.
ControlState probe_control(const sockaddr_in& camera, const ports::Clock& clock, int tries = 3,
                           int64_t wait_ns = 100'000'000);

}  // namespace roomcal::drivers
