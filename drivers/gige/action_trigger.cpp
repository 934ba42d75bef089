#include "drivers/gige/action_trigger.h"

#include <array>
#include <optional>
#include <utility>

#include "drivers/gige/ipv4.h"
#include "drivers/os/wait.h"
#include "runtime/base/text_writer.h"

namespace roomcal::drivers {

ActionTrigger::ActionTrigger(const ActionOptions& options, const ports::SystemClocks& clocks, ports::Log& log)
    : options_(options), clocks_(clocks), log_(log) {}

Status ActionTrigger::open() {
  counters_ = {};
  action_time_ = {};
  const bool schedulable = options_.cameras_clock == ClockId::kTai || options_.cameras_clock == ClockId::kRealtime;
  if (options_.lead_ns < 0 || (options_.lead_ns > 0 && !schedulable))
    return {StatusCode::kInvalidArgument, "a scheduled action needs a positive lead and cameras on tai or realtime"};
  const std::optional<sockaddr_in> to = ipv4_endpoint(options_.address.view(), options_.port);
  if (!to) return {StatusCode::kInvalidArgument, "the action command's address is not an IPv4 address"};
  to_ = *to;
  Result<UniqueFd> socket = open_udp_socket(options_.local_address.view());
  if (!socket.ok()) return socket.status();
  socket_ = std::move(socket).value();
  return ok_status();
}

Status ActionTrigger::schedule(gvcp::ActionCommand& command) {
  action_time_ = {};
  if (options_.lead_ns == 0) return ok_status();
  const Stamp now = clocks_.read(options_.cameras_clock);
  if (now.ns <= 0) return {StatusCode::kUnavailable, "the host does not have the cameras' clock; run PTP on it"};
  action_time_ = {now.ns + options_.lead_ns, now.clock};
  command.action_time = static_cast<uint64_t>(action_time_.ns);
  return ok_status();
}

Status ActionTrigger::fire() {
  gvcp::ActionCommand command;
  last_id_ = static_cast<uint16_t>(last_id_ % 0xFFFF + 1);  // 0 is no id
  command.id = last_id_;
  command.device_key = options_.device_key;
  command.group_key = options_.group_key;
  command.group_mask = options_.group_mask;
  command.acknowledge = options_.expected_acknowledgements > 0;
  ROOMCAL_TRY(schedule(command));
  const gvcp::Datagram datagram = gvcp::action_command(command);
  if (!send_datagram(socket_.get(), to_, datagram.span())) {
    ++counters_.not_sent;
    return {StatusCode::kUnavailable, "the action command could not be sent; check the network to the cameras"};
  }
  ++counters_.sent;
  if (command.acknowledge) collect(command.id);
  return ok_status();
}

void ActionTrigger::collect(uint16_t id) {
  const int64_t deadline_ns = clocks_.now_ns() + options_.acknowledgement_wait_ns;
  const std::array<int, 1> fds{socket_.get()};
  int missing = options_.expected_acknowledgements;
  // The clock ends it, too: datagrams of others must not hold the trigger up.
  while (missing > 0 && clocks_.now_ns() < deadline_ns && wait_readable(fds, deadline_ns) != 0)
    if (receive(id)) --missing;
  counters_.missing += static_cast<uint64_t>(missing);
}

// Whether what has come belongs to this request: older answers may still be on their way.
bool ActionTrigger::receive(uint16_t id) {
  std::array<std::byte, 64> bytes;
  const auto ack = gvcp::parse_acknowledgement(receive_datagram(socket_.get(), bytes), gvcp::Answer::kAction);
  if (!ack || ack->id != id) return false;
  if (ack->status == gvcp::kSuccess) {
    ++counters_.acknowledged;
  } else {
    ++counters_.refused;
    if (ack->status == gvcp::kActionLate) ++counters_.late;
    if (ack->status != counters_.last_status) note_refusal(ack->status);
    counters_.last_status = ack->status;
  }
  return true;
}

void ActionTrigger::note_refusal(uint16_t status) {
  std::array<char, 160> line;
  TextWriter out(line);
  out.text("a camera refuses with GVCP status 0x").hex(status);
  if (status == gvcp::kActionLate) out.text(": too late; lengthen the lead, check PTP");
  if (status == gvcp::kNoReferenceTime) out.text(": it has no time to schedule by; switch its PTP on");
  if (status == gvcp::kOverflow) out.text(": too many actions wait; shorten the lead");
  log_.note(name(), out.view());
}

}  // namespace roomcal::drivers
