#pragma once

#include <cstddef>

#include <linux/can.h>

#include "runtime/base/status.h"
#include "runtime/ports/can_bus.h"

namespace roomcal::drivers {

/// A message as the kernel takes it.
struct CanFrame {
  canfd_frame frame{};
  std::size_t bytes = 0;  ///< CAN_MTU, or CANFD_MTU for more than eight data bytes
};

/// @param fd  the interface carries CAN FD.
/// @return kInvalidArgument for an identifier or a length that there is not, or CAN FD where it is not carried.
Result<CanFrame> to_frame(const ports::CanMessage& message, bool fd);

/// What the kernel handed over. @param bytes  that it says it wrote.
/// @return false for remote requests, error messages and anything that is not a frame.
bool from_frame(const canfd_frame& frame, std::size_t bytes, ports::CanMessage& message);

/// What an error message of the controller says. Source: linux/can/error.h.
struct CanErrorNews {
  bool has_state = false;
  ports::CanState state = ports::CanState::kActive;
  bool overflow = false;  ///< the controller lost received messages
};
CanErrorNews read_error(const canfd_frame& frame);

}  // namespace roomcal::drivers
