#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <linux/can.h>

#include "drivers/can/can_kernel.h"
#include "runtime/base/fixed_vector.h"

namespace roomcal::fakes {

enum class CanCall : uint8_t { kOpen, kIndex, kFlags, kMtu, kSetOption, kGetOption, kBind, kSend, kReceive, kCount };

/// This call fails so many times, from its n-th on (counted from 0 since the script was set).
struct CanFault {
  CanCall call = CanCall::kCount;
  int at = 0;
  int times = 1;
  int error_number = 0;
};

/// A kernel with one CAN interface and one socket at a time. Filters, confirmation and losses work as in Linux;
/// whatever else goes wrong, the script says. No heap of its own.
class FakeCanKernel final : public drivers::CanKernel {
 public:
  int open_raw() override;
  void close(int fd) override;
  int interface_index(int fd, const char* name) override;
  int interface_flags(int fd, const char* name) override;
  int interface_mtu(int fd, const char* name) override;
  int set_option(int fd, int level, int option, const void* value, std::size_t bytes) override;
  int get_option(int fd, int level, int option, void* value, std::size_t bytes) override;
  int bind_to(int fd, int interface_index) override;
  long send(int fd, const void* frame, std::size_t bytes) override;
  long receive(int fd, msghdr& into) override;

  /// A frame comes in from the bus; lost and counted if the queue is full, ignored if no filter wants it.
  void arrive(const canfd_frame& frame, std::size_t bytes = CAN_MTU, bool own = false);
  /// The controller has something to say.
  void arrive_error(uint32_t classes, uint8_t control = 0);
  /// Unplugged: the socket learns of it by its next call.
  void unplug();
  /// Plugged in again, with another number.
  void plug();
  void set_up(bool up);

  void set_script(const CanFault& fault);
  int calls(CanCall call) const { return calls_[static_cast<std::size_t>(call)]; }
  int open_sockets() const { return open_; }
  const canfd_frame& last_sent() const { return last_sent_; }
  std::size_t last_sent_bytes() const { return last_sent_bytes_; }

  static constexpr std::size_t kQueue = 64;
  int mtu = CAN_MTU;
  int64_t stamp_ns = 1'700'000'000'000'000'000;  ///< of what arrives next
  bool stamps = true;                            ///< false: messages come without one
  bool confirms = true;                          ///< false: sent messages do not come back

 private:
  struct Queued {
    canfd_frame frame{};
    std::size_t bytes = 0;
    bool own = false;
    int64_t stamp_ns = 0;
    uint32_t drops = 0;
  };

  int scripted(CanCall call);
  int checked(int fd, CanCall call);
  bool wanted(canid_t id) const;
  void queue(const canfd_frame& frame, std::size_t bytes, bool own);
  void put_control(const Queued& item, msghdr& into) const;

  CanFault fault_;
  std::array<int, static_cast<std::size_t>(CanCall::kCount)> calls_{};
  int next_fd_ = 100, fd_ = -1, open_ = 0;
  bool present_ = true, up_ = true, bound_ = false;
  int index_ = 4;
  int pending_error_ = 0;
  FixedVector<can_filter, 64> filters_;
  can_err_mask_t error_classes_ = 0;
  bool own_ = false, fd_frames_ = false, wants_stamps_ = false, wants_drops_ = false;
  uint32_t drops_ = 0;
  std::array<Queued, kQueue> queue_{};
  std::size_t head_ = 0, size_ = 0;
  canfd_frame last_sent_{};
  std::size_t last_sent_bytes_ = 0;
};

}  // namespace roomcal::fakes
