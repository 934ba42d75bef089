#include "drivers/lidar_udp/udp_packet_source.h"

#include <cerrno>
#include <cstring>

#include <arpa/inet.h>
#include <linux/time_types.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "drivers/lidar_udp/udp_socket.h"
#include "drivers/os/linux_clocks.h"
#include "drivers/os/time_ns.h"
#include "runtime/base/arena.h"
#include "runtime/base/text_writer.h"

namespace roomcal::drivers {

namespace {

constexpr int kMaxInterrupts = 4;
constexpr int64_t kLook_ns = 500'000'000;  // at the interface, while nothing comes
constexpr std::size_t kControlBytes = CMSG_SPACE(sizeof(__kernel_timespec)) + CMSG_SPACE(sizeof(uint32_t));

}  // namespace

struct UdpPacketSource::Slots {
  std::array<mmsghdr, kBatch> messages{};
  std::array<iovec, kBatch> places{};
  std::array<sockaddr_in, kBatch> senders{};
  struct alignas(cmsghdr) Control {
    std::array<std::byte, kControlBytes> bytes{};
  };
  std::array<Control, kBatch> controls{};
};

std::size_t UdpPacketSource::memory_bytes(const UdpOptions& options) {
  return sizeof(Slots) + alignof(Slots) + kBatch * std::size_t{options.max_payload};
}

Status UdpPacketSource::lay_out() {
  Arena arena(memory_);
  const std::span<Slots> slots = arena.allocate<Slots>(1);
  const std::span<std::byte> payloads = arena.allocate<std::byte>(kBatch * std::size_t{options_.max_payload});
  if (slots.empty() || payloads.empty()) return out_of_arena("a LiDAR's packets");
  slots_ = slots.data();
  payloads_ = payloads.data();
  for (std::size_t i = 0; i < kBatch; ++i) ready(i);
  return ok_status();
}

Status UdpPacketSource::refuse_buffer() {
  TextWriter text({detail_.data(), detail_.size() - 1});
  text.text("the kernel grants a receive buffer of ").unsigned_integer(buffer_bytes_);
  text.text(" bytes; set sysctl net.core.rmem_max=").unsigned_integer(receive_buffer_bytes(options_) / 2 + 1);
  detail_[text.view().size()] = '\0';
  fd_.reset();
  return {StatusCode::kUnavailable, detail_.data()};
}

Status UdpPacketSource::start() {
  stop();
  counters_ = {};
  looked_ns_ = LinuxClocks().now_ns();
  static_cast<void>(parse_ipv4(options_.sender, sender_));
  const Status opened = open();
  if (!opened.ok() && opened.code() != StatusCode::kNotFound) return opened;
  const Status laid_out = lay_out();
  wanted_ = laid_out.ok();
  if (!wanted_) fd_.reset();
  return wanted_ ? opened : laid_out;
}

void UdpPacketSource::stop() {
  fd_.reset();
  wanted_ = false;
}

Status UdpPacketSource::open() {
  drops_ = {};
  ROOMCAL_TRY(open_udp_socket(options_, fd_, buffer_bytes_, joined_));
  return buffer_bytes_ < receive_buffer_bytes(options_) ? refuse_buffer() : ok_status();
}

/// Makes a slot fit for the next packet: the kernel writes into its lengths.
void UdpPacketSource::ready(std::size_t slot) {
  slots_->places[slot] = {payloads_ + slot * options_.max_payload, options_.max_payload};
  msghdr& message = slots_->messages[slot].msg_hdr;
  message = {};
  message.msg_name = &slots_->senders[slot];
  message.msg_namelen = sizeof(sockaddr_in);
  message.msg_iov = &slots_->places[slot];
  message.msg_iovlen = 1;
  message.msg_control = slots_->controls[slot].bytes.data();
  message.msg_controllen = kControlBytes;
}

int UdpPacketSource::receive() {
  for (int i = 0; i < kMaxInterrupts; ++i) {
    const int got = ::recvmmsg(fd_.get(), slots_->messages.data(), kBatch, MSG_DONTWAIT, nullptr);
    if (got >= 0) return got;
    if (errno == EAGAIN || errno == EWOULDBLOCK) return 0;
    if (errno == EINTR) continue;
    ++counters_.errors;
    counters_.error_number = errno;
    return 0;
  }
  return 0;
}

Stamp UdpPacketSource::read_control(std::size_t slot) {
  Stamp stamp;
  msghdr& message = slots_->messages[slot].msg_hdr;
  for (cmsghdr* control = CMSG_FIRSTHDR(&message); control != nullptr; control = CMSG_NXTHDR(&message, control)) {
    if (control->cmsg_level != SOL_SOCKET) continue;
    if (control->cmsg_type == SO_TIMESTAMPNS_NEW) {
      __kernel_timespec time{};
      std::memcpy(&time, CMSG_DATA(control), sizeof time);
      stamp = {to_ns(time.tv_sec, time.tv_nsec), ClockId::kRealtime};
    } else if (control->cmsg_type == SO_RXQ_OVFL) {
      uint32_t reading = 0;
      std::memcpy(&reading, CMSG_DATA(control), sizeof reading);
      drops_.observe(reading);
    }
  }
  return stamp.clock == ClockId::kUnknown ? LinuxClocks().read(ClockId::kRealtime) : stamp;
}

UdpPacketSource::Fate UdpPacketSource::fate_of(std::size_t slot) const {
  const sockaddr_in& from = slots_->senders[slot];
  if (sender_ != 0 && from.sin_addr.s_addr != sender_) return Fate::kForeign;
  if (options_.sender_port != 0 && ntohs(from.sin_port) != options_.sender_port) return Fate::kForeign;
  return (slots_->messages[slot].msg_hdr.msg_flags & MSG_TRUNC) != 0 ? Fate::kTruncated : Fate::kDelivered;
}

bool UdpPacketSource::take(std::size_t slot, ports::PacketVisitor& visitor) {
  const Stamp arrived = read_control(slot);
  counters_.kernel_drops = drops_.total();
  const Fate fate = fate_of(slot);
  ++(fate == Fate::kForeign ? counters_.foreign : fate == Fate::kTruncated ? counters_.truncated : counters_.delivered);
  if (fate == Fate::kDelivered)
    visitor.take({{payloads_ + slot * options_.max_payload, slots_->messages[slot].msg_len}, arrived});
  ready(slot);
  return fate == Fate::kDelivered;
}

/// A loss with no packet behind it shows only here.
void UdpPacketSource::read_socket_drops() {
  uint32_t reading = 0;
  if (read_drops(fd_.get(), reading)) drops_.observe(reading);
  counters_.kernel_drops = drops_.total();
}

void UdpPacketSource::look_at_interface() {
  const int64_t now_ns = LinuxClocks().now_ns();
  if (now_ns - looked_ns_ < kLook_ns) return;
  looked_ns_ = now_ns;
  if (fd_.valid())
    static_cast<void>(rejoin_group(fd_.get(), options_, joined_));
  else
    static_cast<void>(open());  // whatever it says now: the interface may come back as it should be
}

std::size_t UdpPacketSource::drain(ports::PacketVisitor& visitor) {
  if (wanted_ && !fd_.valid()) look_at_interface();
  if (!fd_.valid()) return 0;
  std::size_t delivered = 0, taken = 0;
  for (std::size_t got = kBatch; got == kBatch && taken < kMaxDrain; taken += got) {
    got = static_cast<std::size_t>(receive());
    for (std::size_t slot = 0; slot < got; ++slot) delivered += take(slot, visitor) ? 1 : 0;
  }
  read_socket_drops();
  if (taken == 0 && joined_ != 0) look_at_interface();
  return delivered;
}

}  // namespace roomcal::drivers
