#include "tests/fakes/fake_can_kernel.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>

#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/sock_diag.h>
#include <net/if.h>

namespace roomcal::fakes {

void FakeCanKernel::set_script(const CanFault& fault) {
  fault_ = fault;
  calls_.fill(0);
}

/// @return -errno if the script lets this call fail, else 0.
int FakeCanKernel::scripted(CanCall call) {
  const int number = calls_[static_cast<std::size_t>(call)]++;
  const bool hit = call == fault_.call && number >= fault_.at && number < fault_.at + fault_.times;
  return hit ? -fault_.error_number : 0;
}

int FakeCanKernel::checked(int fd, CanCall call) {
  if (const int failed = scripted(call); failed != 0) return failed;
  return fd == fd_ && fd >= 0 ? 0 : -EBADF;
}

int FakeCanKernel::open_raw() {
  if (const int failed = scripted(CanCall::kOpen); failed != 0) return failed;
  ++open_;
  fd_ = next_fd_++;
  bound_ = own_ = fd_frames_ = wants_stamps_ = wants_drops_ = false;
  pending_error_ = 0;
  filters_.clear();
  error_classes_ = 0;
  drops_ = 0;
  head_ = size_ = 0;
  return fd_;
}

void FakeCanKernel::close(int fd) {
  if (fd != fd_) return;
  --open_;
  fd_ = -1;
}

int FakeCanKernel::interface_index(int fd, const char*) {
  if (const int failed = checked(fd, CanCall::kIndex); failed != 0) return failed;
  return present_ ? index_ : -ENODEV;
}

int FakeCanKernel::interface_flags(int fd, const char*) {
  if (const int failed = checked(fd, CanCall::kFlags); failed != 0) return failed;
  return !present_ ? -ENODEV : up_ ? IFF_UP | IFF_RUNNING : 0;
}

int FakeCanKernel::interface_mtu(int fd, const char*) {
  if (const int failed = checked(fd, CanCall::kMtu); failed != 0) return failed;
  return present_ ? mtu : -ENODEV;
}

int FakeCanKernel::set_option(int fd, int level, int option, const void* value, std::size_t bytes) {
  if (const int failed = checked(fd, CanCall::kSetOption); failed != 0) return failed;
  if (level == SOL_CAN_RAW && option == CAN_RAW_FILTER) {
    filters_.clear();
    for (std::size_t i = 0; i < bytes / sizeof(can_filter); ++i) {
      can_filter filter{};
      std::memcpy(&filter, static_cast<const char*>(value) + i * sizeof(filter), sizeof(filter));
      if (!filters_.push_back(filter)) return -EINVAL;
    }
    return 0;
  }
  int number = 0;
  std::memcpy(&number, value, std::min(bytes, sizeof(number)));
  if (level == SOL_CAN_RAW && option == CAN_RAW_ERR_FILTER) error_classes_ = static_cast<can_err_mask_t>(number);
  if (level == SOL_CAN_RAW && option == CAN_RAW_RECV_OWN_MSGS) own_ = number != 0;
  if (level == SOL_CAN_RAW && option == CAN_RAW_FD_FRAMES) fd_frames_ = number != 0;
  if (level == SOL_SOCKET && option == SO_TIMESTAMPNS) wants_stamps_ = number != 0;
  if (level == SOL_SOCKET && option == SO_RXQ_OVFL) wants_drops_ = number != 0;
  return 0;
}

int FakeCanKernel::get_option(int fd, int level, int option, void* value, std::size_t bytes) {
  if (const int failed = checked(fd, CanCall::kGetOption); failed != 0) return failed;
  if (level != SOL_SOCKET || option != SO_MEMINFO || bytes != SK_MEMINFO_VARS * sizeof(uint32_t)) return -ENOPROTOOPT;
  std::memset(value, 0, bytes);
  std::memcpy(static_cast<char*>(value) + SK_MEMINFO_DROPS * sizeof(uint32_t), &drops_, sizeof(drops_));
  return 0;
}

int FakeCanKernel::bind_to(int fd, int interface_index) {
  if (const int failed = checked(fd, CanCall::kBind); failed != 0) return failed;
  if (!present_ || interface_index != index_) return -ENODEV;
  bound_ = true;
  return 0;
}

long FakeCanKernel::send(int fd, const void* frame, std::size_t bytes) {
  if (const int failed = checked(fd, CanCall::kSend); failed != 0) return failed;
  if (!bound_ || !present_) return -ENXIO;
  if (!up_) return -ENETDOWN;
  if (bytes != CAN_MTU && (bytes != CANFD_MTU || !fd_frames_)) return -EINVAL;
  last_sent_ = {};
  std::memcpy(&last_sent_, frame, bytes);
  last_sent_bytes_ = bytes;
  if (own_ && confirms) arrive(last_sent_, bytes, true);
  return static_cast<long>(bytes);
}

bool FakeCanKernel::wanted(canid_t id) const {
  return std::any_of(filters_.begin(), filters_.end(),
                     [&](const can_filter& f) { return (id & f.can_mask) == (f.can_id & f.can_mask); });
}

void FakeCanKernel::queue(const canfd_frame& frame, std::size_t bytes, bool own) {
  if (size_ == kQueue) {
    ++drops_;
    return;
  }
  queue_[(head_ + size_++) % kQueue] = {frame, bytes, own, stamp_ns, drops_};
}

void FakeCanKernel::arrive(const canfd_frame& frame, std::size_t bytes, bool own) {
  if (bound_ && fd_ >= 0 && wanted(frame.can_id) && (bytes != CANFD_MTU || fd_frames_)) queue(frame, bytes, own);
}

void FakeCanKernel::arrive_error(uint32_t classes, uint8_t control) {
  canfd_frame frame{};
  frame.can_id = CAN_ERR_FLAG | classes;
  frame.len = CAN_ERR_DLC;
  frame.data[1] = control;
  if (bound_ && (classes & error_classes_) != 0) queue(frame, CAN_MTU, false);
}

void FakeCanKernel::unplug() {
  present_ = bound_ = false;
  pending_error_ = ENODEV;
}

void FakeCanKernel::plug() {
  present_ = up_ = true;
  ++index_;
}

void FakeCanKernel::set_up(bool up) {
  if (up_ && !up) pending_error_ = ENETDOWN;
  up_ = up;
}

void FakeCanKernel::put_control(const Queued& item, msghdr& into) const {
  const std::size_t room = into.msg_controllen;
  std::memset(into.msg_control, 0, room);
  cmsghdr* part = CMSG_FIRSTHDR(&into);
  std::size_t used = 0;
  const auto put = [&](int type, const void* value, std::size_t bytes) {
    part->cmsg_level = SOL_SOCKET;
    part->cmsg_type = type;
    part->cmsg_len = CMSG_LEN(bytes);
    std::memcpy(CMSG_DATA(part), value, bytes);
    used += CMSG_SPACE(bytes);
    part = CMSG_NXTHDR(&into, part);
  };
  const timespec time{static_cast<time_t>(item.stamp_ns / 1'000'000'000),
                      static_cast<long>(item.stamp_ns % 1'000'000'000)};
  if (wants_stamps_ && stamps) put(SO_TIMESTAMPNS, &time, sizeof(time));
  if (wants_drops_ && item.drops > 0) put(SO_RXQ_OVFL, &item.drops, sizeof(item.drops));
  into.msg_controllen = used;
}

long FakeCanKernel::receive(int fd, msghdr& into) {
  if (const int failed = checked(fd, CanCall::kReceive); failed != 0) return failed;
  if (pending_error_ != 0) {
    const int error = pending_error_;
    pending_error_ = 0;
    return -error;
  }
  if (size_ == 0) return -EAGAIN;
  const Queued item = queue_[head_];
  head_ = (head_ + 1) % kQueue;
  --size_;
  const std::size_t room = into.msg_iov[0].iov_len;
  std::memcpy(into.msg_iov[0].iov_base, &item.frame, std::min({room, item.bytes, sizeof(item.frame)}));
  put_control(item, into);
  into.msg_flags = (item.own ? MSG_CONFIRM | MSG_DONTROUTE : 0) | (item.bytes > room ? MSG_TRUNC : 0);
  return static_cast<long>(std::min(room, item.bytes));
}

}  // namespace roomcal::fakes
