// A bus on which anything may happen, as the kernel hands it over: rubbish, messages of a vehicle, a panel and a servo,
// errors of the socket, time. Each step is a byte that chooses it and its own bytes. Whatever comes, standstill is only
// believed after good messages, commands only with a nonce that was told, and the servo is only told to turn while it
// turns.

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <deque>
#include <set>
#include <span>

#include <linux/can.h>
#include <linux/can/error.h>
#include <net/if.h>

#include "drivers/can/socketcan.h"
#include "drivers/can/standstill.h"
#include "drivers/can/station.h"
#include "drivers/cia402/servo.h"
#include "tests/drivers/can/vehicle.h"
#include "tests/fakes/manual_clocks.h"

namespace {

using namespace roomcal;
using namespace roomcal::drivers;
using cia402::Servo;
using cia402::ServoStep;

constexpr int64_t kMs = 1'000'000;
constexpr uint8_t kNode = 5;

void require(bool holds) {
  if (!holds) __builtin_trap();
}

/// Takes bytes from the input; zeros after its end.
class Source {
 public:
  explicit Source(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  bool empty() const { return bytes_.empty(); }
  uint8_t byte() {
    if (bytes_.empty()) return 0;
    const uint8_t first = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return first;
  }
  uint32_t number() { return byte() | byte() << 8 | byte() << 16 | static_cast<uint32_t>(byte()) << 24; }

 private:
  std::span<const uint8_t> bytes_;
};

struct Raw {
  canfd_frame frame{};
  long bytes = CAN_MTU;
  int flags = 0;
};

/// The kernel: whatever is put into `queue` comes out, sent frames come back confirmed.
struct FuzzKernel final : CanKernel {
  explicit FuzzKernel(const fakes::ManualClocks& of) : clocks(of) {}
  int open_raw() override {
    queue.clear();
    return 3;
  }
  void close(int) override {}
  int interface_index(int, const char*) override { return next_error == 0 ? 1 : -ENODEV; }
  int interface_flags(int, const char*) override { return IFF_UP; }
  int interface_mtu(int, const char*) override { return CANFD_MTU; }
  int set_option(int, int, int, const void*, std::size_t) override { return 0; }
  int get_option(int, int, int, void*, std::size_t) override { return -ENOPROTOOPT; }
  int bind_to(int, int) override { return 0; }
  long send(int, const void* frame, std::size_t bytes) override {
    Raw raw;
    std::memcpy(&raw.frame, frame, bytes);
    raw.bytes = static_cast<long>(bytes);
    raw.flags = MSG_CONFIRM;
    if (confirms) queue.push_back(raw);
    last = raw.frame;
    if (raw.frame.can_id == dbc::cal_status::kLayout.id) note_nonce(raw.frame);
    if (raw.frame.can_id == cia402::sdo_request_id(kNode)) request = raw.frame;
    int32_t target = 0;
    std::memcpy(&target, raw.frame.data + 2, 4);
    const bool turns = raw.frame.can_id == cia402::rpdo1_id(kNode) && target != 0;
    if (turns) require(servo->step() == ServoStep::kTurn);
    return static_cast<long>(bytes);
  }
  long receive(int, msghdr& into) override {
    if (next_error != 0) {
      const int error = next_error;
      next_error = 0;
      return -error;
    }
    if (queue.empty()) return -EAGAIN;
    const Raw raw = queue.front();
    queue.pop_front();
    std::memcpy(into.msg_iov[0].iov_base, &raw.frame, sizeof(raw.frame));
    put_stamp(into);
    into.msg_flags = raw.flags;
    return raw.bytes;
  }
  void put_stamp(msghdr& into) const {
    cmsghdr* part = CMSG_FIRSTHDR(&into);
    const int64_t ns = clocks.read(ClockId::kRealtime).ns;
    const timespec time{static_cast<time_t>(ns / 1'000'000'000), static_cast<long>(ns % 1'000'000'000)};
    part->cmsg_level = SOL_SOCKET;
    part->cmsg_type = SO_TIMESTAMPNS;
    part->cmsg_len = CMSG_LEN(sizeof(time));
    std::memcpy(CMSG_DATA(part), &time, sizeof(time));
    into.msg_controllen = CMSG_SPACE(sizeof(time));
  }
  void note_nonce(const canfd_frame& frame) {
    nonce = static_cast<uint32_t>(frame.data[5] | frame.data[6] << 8 | frame.data[7] << 16);
    nonces.insert(nonce);
  }

  const fakes::ManualClocks& clocks;
  std::deque<Raw> queue;
  int next_error = 0;
  bool confirms = true;
  canfd_frame last{}, request{};
  uint32_t nonce = 0;
  std::set<uint32_t> nonces;
  const Servo* servo = nullptr;
};

struct World {
  World() {
    kernel.servo = &servo;
    require(dispatcher.add(station).ok() && dispatcher.add(standstill).ok() && dispatcher.add(servo).ok());
    require(bus.start({"can0", dispatcher.ids()}).ok());
  }

  void step(Source& source) {
    switch (source.byte() % 12) {
      case 0:
        return pass(1 + source.byte() % 32);
      case 1:
        return rubbish(source);
      case 2:
        return vehicle(source);
      case 3:
        return command(source);
      case 4:
        return node_says(source);
      case 5:
        return answer_request(source);
      case 6:
        return servo.power_on();
      case 7:
        static_cast<void>(servo.turn(0.01 * static_cast<int8_t>(source.byte())));
        return;
      case 8:
        return source.byte() % 2 == 0 ? servo.stop() : servo.power_off();
      case 9:
        kernel.next_error = source.byte();
        return;
      case 10:
        kernel.confirms = source.byte() % 4 != 0;
        return;
      default:
        clocks.step_realtime((static_cast<int8_t>(source.byte())) * kMs);
    }
  }

  void pass(int ms) {
    clocks.advance(ms * kMs);
    dispatcher.poll();
    if (bus.state() == ports::CanState::kDown || bus.state() == ports::CanState::kBusOff) doubted_ns = clocks.now_ns();
    station.poll();
    servo.poll();
    check();
  }

  void put(const ports::CanMessage& message) {
    Raw raw;
    raw.frame.can_id = message.id;
    raw.frame.len = message.length;
    std::copy_n(message.data.begin(), message.length, raw.frame.data);
    raw.bytes = message.length > 8 ? CANFD_MTU : CAN_MTU;
    kernel.queue.push_back(raw);
  }

  void rubbish(Source& source) {
    Raw raw;
    raw.bytes = source.byte() % 80;
    raw.flags = source.byte() % 4 == 0 ? MSG_TRUNC : 0;
    // Half of it with an identifier that somebody wants.
    const auto ids = dispatcher.ids();
    raw.frame.can_id = source.byte() % 2 == 0 ? source.number() : ids[source.byte() % ids.size()].id;
    raw.frame.len = source.byte();
    for (uint8_t& byte : raw.frame.data) byte = source.byte();
    kernel.queue.push_back(raw);
  }

  void vehicle(Source& source) {
    test::Motion motion;
    const uint8_t what = source.byte();
    if (what % 4 == 1) motion.standstill = static_cast<dbc::veh_motion::Standstill>(what >> 6);
    if (what % 4 == 2) motion.speed_mps = 0.001 * what;
    ports::CanMessage message = test::motion_message(motion, counter);
    const bool standing = motion.standstill == dbc::veh_motion::Standstill::kStanding && motion.speed_mps <= 0.01;
    counter = counter_after(counter);
    if (what % 4 == 3) message.data[what >> 4 & 3] ^= what;
    good_in_a_row = standing && what % 4 != 3 ? good_in_a_row + 1 : 0;
    put(message);
  }

  void command(Source& source) {
    namespace cmd = dbc::cal_cmd;
    ports::CanMessage message = blank(cmd::kLayout);
    const uint8_t what = source.byte();
    put_raw(cmd::kCommand, what & 0x0F, message);
    put_raw(cmd::kNonce, what < 128 ? kernel.nonce : source.number() & 0xFFFFFF, message);
    protect(cmd::kLayout, static_cast<uint8_t>(what % kCounterSteps), message);
    put(message);
  }

  // Heartbeat, emergency or position of the node.
  void node_says(Source& source) {
    ports::CanMessage message;
    const uint8_t what = source.byte();
    message.id = what % 3 == 0   ? cia402::heartbeat_id(kNode)
                 : what % 3 == 1 ? cia402::emergency_id(kNode)
                                 : cia402::tpdo1_id(kNode);
    message.length = what % 3 == 0 ? 1 : what % 3 == 1 ? 8 : 6;
    for (std::size_t i = 0; i < 4; ++i) message.data[i] = source.byte();
    put(message);
  }

  // The node takes what was asked of it last, or says no.
  void answer_request(Source& source) {
    ports::CanMessage message;
    message.id = cia402::sdo_answer_id(kNode);
    message.length = 8;
    std::copy_n(kernel.request.data, 4, message.data.begin());
    const uint8_t what = source.byte();
    message.data[0] = what == 255 ? 0x80 : kernel.request.data[0] == 0x40 ? 0x43 : 0x60;
    for (std::size_t i = 4; i < 8; ++i) message.data[i] = source.byte();
    put(message);
  }

  void check() {
    const ports::Stillness stillness = standstill.look(clocks.now_ns());
    require(stillness.still == stillness.why.empty());
    if (stillness.still) require(good_in_a_row >= 3 && clocks.now_ns() - doubted_ns >= 150 * kMs);
    for (CalCommand got; station.next_command(got);) require(got.command != dbc::cal_cmd::Command::kNone);
    require(station.counters().commands <= kernel.nonces.size());
    for (TriggerMark mark; station.next_mark(mark);) require(mark.sender_s >= 0);
    for (cia402::ServoPosition at; servo.next_position(at);) require(at.on_bus.clock == ClockId::kRealtime);
    const bool faulted = servo.step() == ServoStep::kFaulted;
    require(servo.step() < ServoStep::kCount);
    if (faulted) require(!servo.reason().empty());
  }

  fakes::ManualClocks clocks;
  FuzzKernel kernel{clocks};
  SocketCan bus{kernel, clocks};
  Dispatcher dispatcher{bus, clocks};
  Station station{bus, clocks, 1};
  VehicleStandstill standstill{bus, {}};
  Servo servo{bus, clocks, {.node_id = kNode, .homing_method = 17}};
  uint8_t counter = 0;
  int good_in_a_row = 0;
  int64_t doubted_ns = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  World world;
  Source source({data, std::min<std::size_t>(size, 4096)});
  while (!source.empty()) world.step(source);
  return 0;
}
