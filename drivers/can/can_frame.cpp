#include "drivers/can/can_frame.h"

#include <algorithm>
#include <array>

#include <linux/can/error.h>

namespace roomcal::drivers {

namespace {

constexpr std::array<uint8_t, 7> kLongLengths{12, 16, 20, 24, 32, 48, 64};

bool is_long_length(std::size_t length) {
  return std::find(kLongLengths.begin(), kLongLengths.end(), length) != kLongLengths.end();
}

}  // namespace

Result<CanFrame> to_frame(const ports::CanMessage& message, bool fd) {
  if (message.id > (message.extended ? CAN_EFF_MASK : CAN_SFF_MASK))
    return Status{StatusCode::kInvalidArgument, "a CAN identifier has 11 bits, or 29 if it is extended"};
  const bool is_long = message.length > CAN_MAX_DLEN;
  if (is_long && !is_long_length(message.length))
    return Status{StatusCode::kInvalidArgument, "CAN carries 0 to 8 bytes, CAN FD also 12, 16, 20, 24, 32, 48, 64"};
  if (is_long && !fd)
    return Status{StatusCode::kInvalidArgument, "more than 8 bytes need an interface that is set up for CAN FD"};
  CanFrame result;
  result.frame.can_id = message.id | (message.extended ? CAN_EFF_FLAG : 0);
  result.frame.len = message.length;
  result.frame.flags = is_long ? CANFD_BRS : 0;
  std::copy_n(message.data.begin(), message.length, result.frame.data);
  result.bytes = is_long ? CANFD_MTU : CAN_MTU;
  return result;
}

bool from_frame(const canfd_frame& frame, std::size_t bytes, ports::CanMessage& message) {
  const std::size_t room = bytes == CAN_MTU ? CAN_MAX_DLEN : bytes == CANFD_MTU ? CANFD_MAX_DLEN : 0;
  if (room == 0 || frame.len > room || (frame.can_id & (CAN_ERR_FLAG | CAN_RTR_FLAG)) != 0) return false;
  message = {};
  message.extended = (frame.can_id & CAN_EFF_FLAG) != 0;
  message.id = frame.can_id & (message.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  message.length = frame.len;
  std::copy_n(frame.data, frame.len, message.data.begin());
  return true;
}

CanErrorNews read_error(const canfd_frame& frame) {
  CanErrorNews news;
  const auto tell = [&](ports::CanState state) {
    news.has_state = true;
    news.state = state;
  };
  if ((frame.can_id & CAN_ERR_CRTL) != 0) {
    const unsigned control = frame.data[1];
    if ((control & CAN_ERR_CRTL_ACTIVE) != 0) tell(ports::CanState::kActive);
    if ((control & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) tell(ports::CanState::kWarning);
    if ((control & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) tell(ports::CanState::kPassive);
    news.overflow = (control & CAN_ERR_CRTL_RX_OVERFLOW) != 0;
  }
  if ((frame.can_id & CAN_ERR_RESTARTED) != 0) tell(ports::CanState::kActive);
  if ((frame.can_id & CAN_ERR_BUSOFF) != 0) tell(ports::CanState::kBusOff);
  return news;
}

}  // namespace roomcal::drivers
