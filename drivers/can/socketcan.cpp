#include "drivers/can/socketcan.h"

#include <cerrno>
#include <cstring>
#include <ctime>

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/sock_diag.h>
#include <net/if.h>

#include "drivers/can/can_frame.h"
#include "drivers/os/time_ns.h"

namespace roomcal::drivers {

namespace {

constexpr int64_t kLookEvery_ns = 100'000'000;
constexpr int64_t kTryInBusOff_ns = 1'000'000'000;
constexpr int64_t kSendPause_ns = 500'000;  // two of the longest messages at 500 kbit/s
constexpr int kSendTries = 5;
constexpr int kInterrupts = 16;
constexpr int kSkipped = 4096;  // more than a socket's default buffer holds
constexpr can_err_mask_t kErrorClasses = CAN_ERR_CRTL | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED;

// Data messages of exactly this identifier: with EFF and RTR in the mask neither its 29-bit namesake nor a remote
// request passes.
can_filter filter_of(const CanId& id) {
  const canid_t flag = id.extended ? CAN_EFF_FLAG : 0;
  return {id.id | flag, (id.extended ? CAN_EFF_MASK : CAN_SFF_MASK) | CAN_EFF_FLAG | CAN_RTR_FLAG};
}

bool is_gone(int error) { return error == ENETDOWN || error == ENODEV || error == ENXIO; }

}  // namespace

SocketCan::~SocketCan() { close_socket(); }

void SocketCan::close_socket() {
  if (socket_ >= 0) kernel_.close(socket_);
  socket_ = -1;
  state_ = ports::CanState::kDown;
}

Status SocketCan::fail(int result, const char* what) {
  error_number_ = -result;
  return {StatusCode::kUnavailable, what};
}

/// Throws the socket away; another one is made when it is time to look again.
Status SocketCan::give_up(Status why) {
  close_socket();
  trouble_ = why;
  next_look_ns_ = clocks_.now_ns() + kLookEvery_ns;
  return why;
}

Status SocketCan::start(const SocketCanOptions& options) {
  close_socket();
  const std::size_t length = std::strlen(options.interface);
  if (length == 0 || length >= IFNAMSIZ)
    return {StatusCode::kInvalidArgument, "a CAN interface's name has 1 to 15 characters"};
  interface_ = options.interface;
  ids_.clear();
  for (const CanId& id : options.ids)
    if (!ids_.push_back(id)) return {StatusCode::kInvalidArgument, "too many CAN identifiers for one interface"};
  return open_socket();
}

Status SocketCan::open_socket() {
  socket_ = kernel_.open_raw();
  if (socket_ == -EAFNOSUPPORT || socket_ == -EPROTONOSUPPORT)
    return give_up(fail(socket_, "the kernel has no CAN; load its modules can and can_raw"));
  if (socket_ < 0) return give_up(fail(socket_, "no CAN socket can be had; check permissions and open files"));
  int index = 0;
  if (const Status found = find_interface(index); !found.ok()) return give_up(found);
  if (const Status set = set_options(); !set.ok()) return give_up(set);
  if (const int bound = kernel_.bind_to(socket_, index); bound < 0)
    return give_up(fail(bound, "the CAN interface cannot be used; check that it is one for CAN"));
  state_ = ports::CanState::kActive;
  socket_drops_ = 0;
  error_number_ = 0;
  trouble_ = ok_status();
  return ok_status();
}

Status SocketCan::find_interface(int& index) {
  index = kernel_.interface_index(socket_, interface_);
  if (index < 0) return fail(index, "there is no CAN interface of this name; plug it in, or mend the name");
  const int flags = kernel_.interface_flags(socket_, interface_);
  if (flags < 0) return fail(flags, "the CAN interface does not tell its state; plug it in again");
  if ((flags & IFF_UP) == 0)
    return fail(-ENETDOWN, "the CAN interface is not up; ip link set can0 up type can bitrate 500000");
  const int mtu = kernel_.interface_mtu(socket_, interface_);
  if (mtu < 0) return fail(mtu, "the CAN interface does not tell its MTU; plug it in again");
  fd_frames_ = mtu >= static_cast<int>(CANFD_MTU);
  return ok_status();
}

Status SocketCan::set_options() {
  const int on = 1;
  std::array<can_filter, kMaxCanIds> filters;
  for (std::size_t i = 0; i < ids_.size(); ++i) filters[i] = filter_of(ids_[i]);
  int result =
      kernel_.set_option(socket_, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(), ids_.size() * sizeof(can_filter));
  if (result < 0) return fail(result, "the CAN socket takes no filters; update the kernel");
  result = kernel_.set_option(socket_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &kErrorClasses, sizeof(kErrorClasses));
  if (result < 0) return fail(result, "the CAN socket takes no error filter; update the kernel");
  result = kernel_.set_option(socket_, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, &on, sizeof(on));
  if (result < 0) return fail(result, "the CAN socket does not confirm sent messages; update the kernel");
  result = kernel_.set_option(socket_, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof(on));
  if (result < 0) return fail(result, "the CAN socket gives no time stamps; update the kernel");
  result = kernel_.set_option(socket_, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof(on));
  if (result < 0) return fail(result, "the CAN socket does not count losses; update the kernel");
  // An old kernel or driver without CAN FD carries classic messages all the same.
  if (fd_frames_) fd_frames_ = kernel_.set_option(socket_, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof(on)) >= 0;
  return ok_status();
}

void SocketCan::look_again() {
  if (interface_[0] != '\0' && clocks_.now_ns() >= next_look_ns_) static_cast<void>(open_socket());
}

void SocketCan::enter(ports::CanState state) {
  if (state == ports::CanState::kBusOff && state_ != state) {
    ++counters_.bus_offs;
    bus_off_ns_ = clocks_.now_ns();
  }
  state_ = state;
}

bool SocketCan::receive(ports::CanMessage& message) {
  if (socket_ < 0) look_again();
  for (int skipped = 0; socket_ >= 0 && skipped < kSkipped; ++skipped) {
    const Taken taken = take_one(message);
    if (taken != Taken::kOther) return taken == Taken::kMessage;
  }
  if (socket_ >= 0) static_cast<void>(give_up({StatusCode::kUnavailable, "the CAN interface floods with errors"}));
  return false;
}

SocketCan::Taken SocketCan::take_one(ports::CanMessage& message) {
  canfd_frame frame{};
  alignas(cmsghdr) std::array<char, 256> control{};
  iovec part{&frame, sizeof(frame)};
  msghdr header{};
  header.msg_iov = &part;
  header.msg_iovlen = 1;
  header.msg_control = control.data();
  header.msg_controllen = control.size();
  long got = -EINTR;
  for (int i = 0; got == -EINTR && i < kInterrupts; ++i) got = kernel_.receive(socket_, header);
  if (got < 0) return nothing_read(static_cast<int>(got));
  const Stamp stamp = read_control(header);
  if ((frame.can_id & CAN_ERR_FLAG) != 0) {
    take_error(frame);
    return Taken::kOther;
  }
  if ((header.msg_flags & MSG_TRUNC) != 0 || !from_frame(frame, static_cast<std::size_t>(got), message))
    return Taken::kOther;
  message.stamp = stamp;
  message.own = (header.msg_flags & MSG_CONFIRM) != 0;
  ++(message.own ? counters_.sent : counters_.received);
  // Whoever carries messages is not off the bus: the word of its restart was lost.
  if (state_ == ports::CanState::kBusOff) enter(ports::CanState::kActive);
  return Taken::kMessage;
}

/// Only an empty queue is left as it is. After any other error it is not known what still waits, nor how old it will
/// be.
SocketCan::Taken SocketCan::nothing_read(int result) {
  if (result == -EAGAIN || result == -EWOULDBLOCK) {
    ask_drops();
    return Taken::kNothing;
  }
  const char* why = is_gone(-result) ? "the CAN interface went down or was unplugged" : "the CAN socket cannot be read";
  static_cast<void>(give_up(fail(result, why)));
  return Taken::kNothing;
}

void SocketCan::take_error(const canfd_frame& frame) {
  ++counters_.error_messages;
  const CanErrorNews news = read_error(frame);
  if (news.overflow) ++counters_.kernel_drops;  // at least one, and lost before the kernel could count it
  if (news.has_state) enter(news.state);
}

Stamp SocketCan::read_control(msghdr& header) {
  Stamp stamp;
  for (cmsghdr* part = CMSG_FIRSTHDR(&header); part != nullptr; part = CMSG_NXTHDR(&header, part)) {
    if (part->cmsg_level != SOL_SOCKET) continue;
    if (part->cmsg_type == SO_TIMESTAMPNS) {
      timespec time{};
      std::memcpy(&time, CMSG_DATA(part), sizeof(time));
      stamp = {to_ns(time), ClockId::kRealtime};
    } else if (part->cmsg_type == SO_RXQ_OVFL) {
      uint32_t total = 0;
      std::memcpy(&total, CMSG_DATA(part), sizeof(total));
      count_drops(total);
    }
  }
  return stamp;
}

/// @param total  since the socket was opened, modulo 2^32.
void SocketCan::count_drops(uint32_t total) {
  const uint32_t more = total - socket_drops_;
  // A message that was queued before a loss comes after we asked for the total: its figure is an old one.
  if (more > 0x7FFFFFFF) return;
  counters_.kernel_drops += more;
  socket_drops_ = total;
}

/// SO_RXQ_OVFL comes with the next message only; after a loss and then silence this is how to know.
void SocketCan::ask_drops() {
  std::array<uint32_t, SK_MEMINFO_VARS> facts{};
  if (kernel_.get_option(socket_, SOL_SOCKET, SO_MEMINFO, facts.data(), sizeof(facts)) >= 0)
    count_drops(facts[SK_MEMINFO_DROPS]);
}

bool SocketCan::may_send() const {
  // If the word of the restart was lost and nobody else talks, only a try tells.
  return state_ != ports::CanState::kBusOff || clocks_.now_ns() - bus_off_ns_ >= kTryInBusOff_ns;
}

Status SocketCan::refuse(Status why) {
  ++counters_.send_refused;
  trouble_ = why;
  return why;
}

Status SocketCan::send(const ports::CanMessage& message) {
  const Result<CanFrame> frame = to_frame(message, fd_frames_);
  if (!frame.ok()) return refuse(frame.status());
  // Why the interface is down says more than that it is.
  if (socket_ < 0)
    return refuse(trouble_.ok() ? Status{StatusCode::kUnavailable, "start() the CAN bus first"} : trouble_);
  if (!may_send())
    return refuse({StatusCode::kUnavailable, "the CAN controller is bus-off; check wiring and bit rate"});
  if (state_ == ports::CanState::kBusOff) bus_off_ns_ = clocks_.now_ns();
  long sent = 0;
  for (int i = 0; i < kSendTries; ++i) {
    if (i > 0) clocks_.sleep_until(clocks_.now_ns() + kSendPause_ns);
    sent = kernel_.send(socket_, &frame.value().frame, frame.value().bytes);
    if (sent != -ENOBUFS && sent != -EAGAIN && sent != -EWOULDBLOCK && sent != -EINTR) break;
  }
  if (sent == static_cast<long>(frame.value().bytes)) return ok_status();
  return after_failed_send(static_cast<int>(sent));
}

Status SocketCan::after_failed_send(int result) {
  if (result == -ENOBUFS || result == -EAGAIN || result == -EWOULDBLOCK || result == -EINTR)
    return refuse(fail(result, "the CAN queue stays full; check that somebody acknowledges, raise txqueuelen"));
  if (result < 0 && is_gone(-result))
    return refuse(give_up(fail(result, "the CAN interface went down or was unplugged")));
  return refuse(fail(result, "the CAN socket takes no message"));
}

}  // namespace roomcal::drivers
