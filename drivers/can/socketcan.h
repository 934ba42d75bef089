#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "drivers/can/can_kernel.h"
#include "drivers/can/dispatcher.h"
#include "runtime/ports/can_bus.h"
#include "runtime/ports/system_clocks.h"

struct canfd_frame;

namespace roomcal::drivers {

struct SocketCanOptions {
  const char* interface = "can0";  ///< kept
  std::span<const CanId> ids;      ///< all that is heard or sent (Dispatcher::ids()); nothing else gets through
};

/// One CAN interface by a raw socket of Linux: can0, or vcan0 without hardware.
///
/// Messages carry the kernel's stamp (realtime). Own ones come back when they were on the bus, with the stamp of that.
/// CAN FD where the interface's MTU says so. A socket that fails is replaced, and an interface that is gone or down is
/// looked for by its name every 100 ms: its number changes when an adapter is plugged in again, and what waited in the
/// old socket is too old to be believed. Polling costs two calls and, unlike a netlink socket, cannot overflow.
///
/// The controller's bit rate, and `restart-ms` after a bus-off, are the board's to set up (`ip link set`).
/// No heap. Errors: error_number() and trouble() tell of the last one, for the log.
class SocketCan final : public ports::CanBus {
 public:
  /// Both outlive the bus.
  SocketCan(CanKernel& kernel, const ports::SystemClocks& clocks) : kernel_(kernel), clocks_(clocks) {}
  ~SocketCan() override;
  SocketCan(const SocketCan&) = delete;
  SocketCan& operator=(const SocketCan&) = delete;

  /// @return kInvalidArgument for a name that is too long or too many identifiers; kUnavailable with the remedy if the
  ///         interface is not there or not up: receive() then goes on looking for it.
  Status start(const SocketCanOptions& options);

  /// @return besides the port's: kInvalidArgument for what no CAN message can be, or CAN FD on a classic interface.
  /// A full queue is waited for, at most 2 ms.
  Status send(const ports::CanMessage& message) override;
  /// @return false also means that nothing waits: the queue was empty, or is thrown away.
  bool receive(ports::CanMessage& message) override;
  ports::CanState state() const override { return state_; }
  const ports::CanCounters& counters() const override { return counters_; }

  /// Why the bus is down, what the last send ran into; ok if nothing did.
  Status trouble() const { return trouble_; }
  int error_number() const { return error_number_; }
  bool carries_fd() const { return fd_frames_; }

 private:
  enum class Taken : uint8_t { kMessage, kOther, kNothing };

  Status fail(int result, const char* what);
  Status open_socket();
  Status find_interface(int& index);
  Status set_options();
  void look_again();
  Status give_up(Status why);
  void close_socket();
  Taken take_one(ports::CanMessage& message);
  Taken nothing_read(int result);
  void take_error(const canfd_frame& frame);
  Stamp read_control(msghdr& header);
  void count_drops(uint32_t total);
  void ask_drops();
  void enter(ports::CanState state);
  bool may_send() const;
  Status refuse(Status why);
  Status after_failed_send(int result);

  CanKernel& kernel_;
  const ports::SystemClocks& clocks_;
  const char* interface_ = "";
  FixedVector<CanId, kMaxCanIds> ids_;
  int socket_ = -1;
  bool fd_frames_ = false;
  ports::CanState state_ = ports::CanState::kDown;
  int64_t next_look_ns_ = 0, bus_off_ns_ = 0;
  uint32_t socket_drops_ = 0;  ///< that the kernel has told of this socket
  ports::CanCounters counters_;
  Status trouble_;
  int error_number_ = 0;
};

}  // namespace roomcal::drivers
