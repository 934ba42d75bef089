#include "tests/fakes/fake_servo_drive.h"

#include <algorithm>
#include <cmath>

namespace roomcal::fakes {

namespace {

constexpr double kNs = 1e-9;
constexpr int64_t kBoot_ns = 40'000'000;

uint32_t number(const ports::CanMessage& message, std::size_t at, std::size_t count) {
  uint32_t value = 0;
  for (std::size_t i = count; i-- > 0;) value = value << 8 | message.data[at + i];
  return value;
}

uint8_t byte_of(uint32_t value, int at) { return static_cast<uint8_t>(value >> (8 * at)); }

}  // namespace

FakeServoDrive::FakeServoDrive(CanWire& wire, const ports::SystemClocks& clocks, uint8_t node)
    : wire_(wire), clocks_(clocks), node_(node), last_ns_(clocks.now_ns()), boots_at_ns_(last_ns_ + kBoot_ns) {}

uint32_t FakeServoDrive::object(uint16_t index, uint8_t sub) const {
  const auto found = objects_.find({index, sub});
  return found == objects_.end() ? 0 : found->second;
}

void FakeServoDrive::answer(uint32_t id, std::vector<uint8_t> bytes, int64_t after_ns) {
  if (trouble.mute) return;
  ports::CanMessage message;
  message.id = id;
  message.length = static_cast<uint8_t>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), message.data.begin());
  wire_.deliver(message, after_ns);
}

void FakeServoDrive::boot(bool whole_node) {
  booting_ = true;
  nmt_ = 0;
  boots_at_ns_ = clocks_.now_ns() + kBoot_ns;
  master_heard_ns_ = -1;
  objects_ = {{{0x1016, 1}, 0},          {{0x1017, 0}, 0},
              {{0x1005, 0}, 0x80},       {{0x1400, 1}, 0x200U + node_},
              {{0x1400, 2}, 255},        {{0x1800, 1}, 0x40000180U + node_},
              {{0x1800, 2}, 255},        {{0x1600, 0}, 1},
              {{0x1600, 1}, 0x60400010}, {{0x1600, 2}, 0},
              {{0x1A00, 0}, 1},          {{0x1A00, 1}, 0x60410010},
              {{0x1A00, 2}, 0},          {{0x6007, 0}, 1},
              {{0x6083, 0}, 10'000},     {{0x6084, 0}, 10'000},
              {{0x6085, 0}, 50'000},     {{0x6098, 0}, 0},
              {{0x6099, 1}, 1'000},      {{0x6099, 2}, 100},
              {{0x609A, 0}, 10'000},     {{0x6060, 0}, 0},
              {{0x6061, 0}, 0},          {{0x6040, 0}, 0}};
  if (!whole_node) return;
  state_ = trouble.faulty ? State::kFault : State::kDisabled;
  control_ = 0;
  target_ = 0;
  mode_ = 0;
  homing_ = homing_done_ = homing_error_ = false;
}

void FakeServoDrive::reboot() { boot(true); }

void FakeServoDrive::emergency(uint16_t code) {
  answer(0x80U + node_, {byte_of(code, 0), byte_of(code, 1), 0x21, 1, 2, 3, 4, 5});
}

void FakeServoDrive::break_down(uint16_t code) {
  state_ = State::kFault;
  emergency(code);
}

void FakeServoDrive::lose_enable() { state_ = State::kDisabled; }
void FakeServoDrive::leave_operational() { nmt_ = 0x7F; }

void FakeServoDrive::on_bus(const ports::CanMessage& message) {
  if (trouble.mute) return;
  if (message.id == 0x000 && message.length == 2) return hear_nmt(message);
  if (booting_) return;
  if (message.id == 0x600U + node_) return hear_sdo(message);
  const uint32_t master = object(0x1016, 1) >> 16 & 0x7F;
  if (master != 0 && message.id == 0x700U + master) master_heard_ns_ = clocks_.now_ns();
  if (!operational()) return;
  if (message.id == (object(0x1400, 1) & 0x7FF) && !pdo_is_off(0x1400)) hear_command(message);
  if (message.id == 0x080) hear_sync(message);
}

void FakeServoDrive::hear_nmt(const ports::CanMessage& message) {
  if (message.data[1] != 0 && message.data[1] != node_) return;
  const uint8_t command = message.data[0];
  if (command == 0x81) boot(true);
  if (command == 0x82) boot(false);
  if (booting_) return;
  if (command == 0x01 && !trouble.ignores_start) nmt_ = 0x05;
  if (command == 0x02) nmt_ = 0x04;
  if (command == 0x80) nmt_ = 0x7F;
}

void FakeServoDrive::hear_sdo(const ports::CanMessage& message) {
  if (trouble.no_sdo || message.length != 8 || message.data[0] == 0x80) return;
  if (trouble.lose_sdo > 0) {
    --trouble.lose_sdo;
    return;
  }
  const Key key{static_cast<uint16_t>(number(message, 1, 2)), message.data[3]};
  uint32_t abort = 0, value = 0;
  const bool reads = message.data[0] == 0x40;
  if (key.first == trouble.refuse_index) {
    abort = trouble.refuse_code;
  } else if (reads) {
    const bool there = objects_.count(key) > 0 || key.first == 0x1000 || key.first == 0x6502;
    value = key.first == 0x1000   ? trouble.device_type
            : key.first == 0x6502 ? trouble.modes
                                  : object(key.first, key.second);
    if (!there) abort = 0x06020000;
  } else {
    const std::size_t count = 4 - (message.data[0] >> 2 & 3U);
    abort = (message.data[0] & 0xE3) != 0x23 ? 0x05040001 : write(key, number(message, 4, count));
  }
  const uint8_t command = abort != 0 ? 0x80 : reads ? 0x43 : 0x60;
  const uint32_t told = abort != 0 ? abort : value;
  answer(0x580U + node_, {command, message.data[1], message.data[2], message.data[3], byte_of(told, 0),
                          byte_of(told, 1), byte_of(told, 2), byte_of(told, 3)});
}

/// @return an abort code, or 0. Mapping may change only while its PDO is off and has no entries (CiA 301, 7.5.2.36).
uint32_t FakeServoDrive::write(Key key, uint32_t value) {
  if (objects_.count(key) == 0) return 0x06020000;
  const bool maps = key.first == 0x1600 || key.first == 0x1A00;
  const auto communication = static_cast<uint16_t>(key.first - 0x200);
  if (maps && !pdo_is_off(communication)) return 0x06010000;
  if (maps && key.second > 0 && object(key.first, 0) != 0) return 0x06010000;
  const bool is_id = (key.first == 0x1400 || key.first == 0x1800) && key.second == 1;
  const bool moves = is_id && !pdo_is_off(key.first) && (value & 0x80000000) == 0;
  if (moves && (value & 0x1FFFFFFF) != (object(key.first, 1) & 0x1FFFFFFF)) return 0x06090030;
  if (key.first == 0x6061) return 0x06010002;
  objects_[key] = value;
  if (key.first == 0x6040) {
    const uint16_t before = control_;
    control_ = static_cast<uint16_t>(value);
    follow_command(before);
  }
  if (key.first == 0x6060) {
    mode_ = static_cast<int8_t>(value);
    if (!trouble.mode_stays) objects_[{0x6061, 0}] = value;
  }
  return 0;
}

void FakeServoDrive::hear_command(const ports::CanMessage& message) {
  const bool mapped = object(0x1600, 0) == 2 && object(0x1600, 1) == 0x60400010 && object(0x1600, 2) == 0x60FF0020;
  if (!mapped || message.length != 6) return emergency(0x8210);
  const uint16_t before = control_;
  control_ = static_cast<uint16_t>(number(message, 0, 2));
  target_ = static_cast<int32_t>(number(message, 2, 4));
  follow_command(before);
}

void FakeServoDrive::follow_command(uint16_t before) {
  const bool reset_edge = (control_ & 0x80) != 0 && (before & 0x80) == 0;
  if (state_ == State::kFault) {
    if (reset_edge && !trouble.fault_stays) state_ = State::kDisabled;
    return;
  }
  const int low = control_ & 0x0F;
  if ((low & 0x02) == 0) {  // disable voltage
    state_ = State::kDisabled;
  } else if ((low & 0x04) == 0) {  // quick stop
    state_ = state_ == State::kEnabled || state_ == State::kQuickStop ? State::kQuickStop : State::kDisabled;
  } else if (state_ == State::kQuickStop) {
    return;
  } else if ((low & 0x07) == 0x06) {  // shutdown
    if (!trouble.stuck_disabled) state_ = State::kReady;
  } else if (low == 0x07) {
    if (state_ == State::kReady || state_ == State::kEnabled) state_ = State::kSwitchedOn;
  } else if (low == 0x0F) {
    if (state_ == State::kSwitchedOn) state_ = State::kEnabled;
  }
  const bool start = (control_ & 0x10) != 0 && (before & 0x10) == 0;
  if (start && mode_ == 6 && state_ == State::kEnabled) {
    homing_ = true;
    homing_left_s_ = 1.5;
    homing_done_ = homing_error_ = false;
  }
}

void FakeServoDrive::hear_sync(const ports::CanMessage& message) {
  tick();
  const bool mapped = object(0x1A00, 0) == 2 && object(0x1A00, 1) == 0x60410010 && object(0x1A00, 2) == 0x60640020;
  if (trouble.no_tpdo || pdo_is_off(0x1800) || object(0x1800, 2) != 1 || !mapped) return;
  // The position is taken when the SYNC is on the bus, which may be later than it was handed over.
  const int64_t later_ns = message.stamp.ns - clocks_.read(ClockId::kRealtime).ns;
  const double there = position_ + velocity_ * static_cast<double>(later_ns) * kNs;
  latched_.emplace_back(message.stamp.ns, there);
  const uint16_t status = statusword();
  const auto counts = static_cast<uint32_t>(static_cast<int64_t>(std::llround(there)));
  for (int i = 0; i < (trouble.double_tpdo ? 2 : 1); ++i)
    answer(object(0x1800, 1) & 0x7FF,
           {byte_of(status, 0), byte_of(status, 1), byte_of(counts, 0), byte_of(counts, 1), byte_of(counts, 2),
            byte_of(counts, 3)},
           later_ns + 150'000 + tpdo_late_ns_);
}

uint16_t FakeServoDrive::statusword() const {
  constexpr std::array<uint16_t, 7> kBits{0x00, 0x50, 0x31, 0x33, 0x37, 0x17, 0x18};
  uint16_t word = kBits[static_cast<std::size_t>(state_)] | 0x200;
  const bool reached = mode_ == 6 ? homing_done_ : std::abs(velocity_ - target_) < 1;
  if (reached) word |= 1U << 10;
  if (mode_ == 6 && homing_done_) word |= 1U << 12;
  if (mode_ == 6 && homing_error_) word |= 1U << 13;
  if (mode_ == 3 && velocity_ == 0) word |= 1U << 12;
  if (mode_ == 3 && trouble.slips && velocity_ != 0) word |= 1U << 13;
  return word;
}

void FakeServoDrive::tick() {
  const int64_t now_ns = clocks_.now_ns();
  move(static_cast<double>(now_ns - last_ns_) * kNs);
  last_ns_ = now_ns;
  if (booting_ && now_ns >= boots_at_ns_) {
    booting_ = false;
    nmt_ = 0x7F;
    answer(0x700U + node_, {0x00});
    if (trouble.faulty) emergency(0x3120);
  }
  const int64_t period_ns = int64_t{object(0x1017, 0)} * 1'000'000;
  if (!booting_ && period_ns > 0 && now_ns >= next_heartbeat_ns_ && !trouble.no_heartbeat) {
    next_heartbeat_ns_ = now_ns + period_ns;
    answer(0x700U + node_, {nmt_});
  }
  const int64_t patience_ns = int64_t{object(0x1016, 1) & 0xFFFF} * 1'000'000;
  if (master_heard_ns_ >= 0 && patience_ns > 0 && now_ns - master_heard_ns_ > patience_ns) {
    missed_master_ = true;
    master_heard_ns_ = -1;
    if (state_ == State::kEnabled) state_ = State::kQuickStop;
  }
}

void FakeServoDrive::move(double seconds) {
  if (homing_) return step_homing(seconds);
  const bool creeps = trouble.never_stands && state_ == State::kEnabled && target_ == 0 && velocity_ != 0;
  const double wanted = creeps ? std::copysign(5, velocity_) : state_ == State::kEnabled && mode_ == 3 ? target_ : 0;
  const double rate = object(state_ == State::kEnabled ? 0x6083 : 0x6085, 0);
  const double ramp_s = rate > 0 ? std::min(seconds, std::abs(wanted - velocity_) / rate) : 0;
  const double end = rate > 0 ? velocity_ + std::copysign(rate * ramp_s, wanted - velocity_) : wanted;
  position_ += 0.5 * (velocity_ + end) * ramp_s;
  velocity_ = std::abs(end - wanted) < 1e-9 * rate ? wanted : end;
  position_ += velocity_ * (seconds - ramp_s);
}

void FakeServoDrive::step_homing(double seconds) {
  velocity_ = state_ == State::kEnabled ? -static_cast<double>(object(0x6099, 1)) : 0;
  position_ += velocity_ * seconds;
  homing_left_s_ -= seconds;
  if (homing_left_s_ > 0 || trouble.homing_hangs) return;
  homing_ = false;
  velocity_ = 0;
  homing_error_ = trouble.homing_fails;
  homing_done_ = !homing_error_;
  if (!homing_done_) return;
  position_ = 0;
  ++homed_;
}

}  // namespace roomcal::fakes
