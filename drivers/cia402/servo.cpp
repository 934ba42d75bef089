#include "drivers/cia402/servo.h"

#include <cmath>

namespace roomcal::drivers::cia402 {

namespace {

constexpr int64_t kSyncSilence_ns = 200'000'000;  // and two periods
constexpr int64_t kNoAnswer_ns = 500'000'000;     // longer than a heartbeat's time: a cut cable is told as one
constexpr uint16_t kFollowingErrorCode = 0x8611;

}  // namespace

Servo::Servo(ports::CanBus& bus, const ports::Clock& clock, const ServoOptions& options)
    : bus_(bus),
      clock_(clock),
      options_(options),
      ids_{{{kSyncId, false},
            {emergency_id(options.node_id), false},
            {tpdo1_id(options.node_id), false},
            {sdo_answer_id(options.node_id), false},
            {heartbeat_id(options.node_id), false}}},
      setup_(setup_of(options)),
      sdo_(bus, options.node_id, options.sdo_timeout_ns),
      sync_(options.sync_period_ns) {}

void Servo::power_on() { enter(ServoStep::kReset); }

Status Servo::turn(double rate_radps) {
  if (step_ != ServoStep::kReady && step_ != ServoStep::kTurn)
    return {StatusCode::kUnavailable, "the servo is not ready to turn"};
  if (!(std::abs(rate_radps) <= options_.max_speed_radps))
    return {StatusCode::kInvalidArgument, "the servo cannot turn that fast"};
  enter(ServoStep::kTurn);
  target_ = static_cast<int32_t>(std::lround(counts_of(options_, rate_radps) * options_.velocity_units_per_count));
  return ok_status();
}

void Servo::stop() {
  if (step_ == ServoStep::kTurn) enter(ServoStep::kStop);
}

void Servo::power_off() {
  if (step_ != ServoStep::kOff) enter(ServoStep::kPowerOff);
}

bool Servo::at_speed() const { return step_ == ServoStep::kTurn && statuses_ >= 2 && (status_ & kTargetReached) != 0; }

void Servo::fail(ServoFault fault) {
  if (step_ == ServoStep::kFaulted || step_ == ServoStep::kOff) return;
  fault_ = {fault, step_, fault_.emergency, sdo_.key(), sdo_.abort_code(), drive()};
  enter(ServoStep::kFaulted);
}

void Servo::poll() {
  const int64_t now_ns = clock_.now_ns();
  if (step_ == ServoStep::kOff) return;
  sdo_.poll(now_ns);
  supervise(now_ns);
  watch_step_time(now_ns);
  advance(now_ns);
  if (step_ == ServoStep::kOff) return;
  send_heartbeat(now_ns);
  if (syncing_ && sync_.due(now_ns)) send_cycle();
}

void Servo::supervise(int64_t now_ns) {
  if (step_ >= ServoStep::kPowerOff) return;
  const ports::CanState state = bus_.state();
  if (state == ports::CanState::kDown || state == ports::CanState::kBusOff) return fail(ServoFault::kBusDown);
  if (supervised_ && now_ns - heard_ns_ > 3 * options_.heartbeat_period_ns) return fail(ServoFault::kHeartbeatLost);
  if (!syncing_) return;
  if (sync_.silent_ns(now_ns) > kSyncSilence_ns + 2 * options_.sync_period_ns) return fail(ServoFault::kSyncLost);
  const int64_t unanswered_ns = sync_.unanswered_in_a_row() * options_.sync_period_ns;
  if (step_ > ServoStep::kStart && unanswered_ns > kNoAnswer_ns) fail(ServoFault::kNoPosition);
}

void Servo::send_heartbeat(int64_t now_ns) {
  if (now_ns < next_heartbeat_ns_) return;
  next_heartbeat_ns_ = now_ns + options_.heartbeat_period_ns;
  static_cast<void>(bus_.send(heartbeat_message(options_.own_id, NmtState::kOperational)));
}

void Servo::send_cycle() {
  ports::CanMessage command;
  command.id = rpdo1_id(options_.node_id);
  command.length = 6;
  put_le(control_, std::span(command.data).first(2));
  put_le(static_cast<uint32_t>(target_), std::span(command.data).subspan(2, 4));
  // A refused command comes again with the next SYNC.
  static_cast<void>(bus_.send(command));
  sync_.sent(bus_.send(sync_message()).ok());
}

void Servo::hear(const ports::CanMessage& message, const Arrival& arrival) {
  if (step_ == ServoStep::kOff) return;
  if (message.id == kSyncId) return message.own ? sync_.confirmed(message.stamp, arrival.latest_ns) : sync_.disturbed();
  if (message.own) return;
  if (message.id == sdo_answer_id(options_.node_id)) sdo_.hear(message);
  if (message.id == tpdo1_id(options_.node_id)) hear_position(message);
  if (message.id == emergency_id(options_.node_id)) hear_emergency(message);
  if (message.id == heartbeat_id(options_.node_id)) {
    heard_ns_ = arrival.latest_ns;
    hear_heartbeat(message);
  }
}

void Servo::hear_heartbeat(const ports::CanMessage& message) {
  NmtState state{};
  if (!read_heartbeat(message, state)) return;
  node_ = state;
  if (state == NmtState::kBootUp) booted_ = true;
  if (step_ < ServoStep::kIdentify || step_ > ServoStep::kStop) return;
  if (state == NmtState::kBootUp) return fail(ServoFault::kRebooted);
  if (step_ > ServoStep::kStart && state != NmtState::kOperational) fail(ServoFault::kLeftOperation);
}

void Servo::hear_emergency(const ports::CanMessage& message) {
  Emergency emergency;
  if (!read_emergency(message, emergency)) return;
  if (step_ == ServoStep::kFaulted) return explain_fault(emergency.code);
  fault_.emergency = emergency.code;
  if (emergency.code == 0 || !operating()) return;
  fail(emergency.code == kFollowingErrorCode ? ServoFault::kFollowingError : ServoFault::kEmergency);
}

/// The statusword may tell of a fault before the emergency says which; the first one that comes then is it.
void Servo::explain_fault(uint16_t code) {
  if (fault_.fault != ServoFault::kDriveFault || fault_.emergency != 0) return;
  fault_.emergency = code;
  if (code == kFollowingErrorCode) fault_.fault = ServoFault::kFollowingError;
}

void Servo::hear_position(const ports::CanMessage& message) {
  if (message.length != 6 || !syncing_) return;
  const auto bytes = message.bytes();
  status_ = static_cast<uint16_t>(le(bytes.first(2)));
  ++statuses_;
  Stamp on_bus;
  if (sync_.pair(message.stamp, on_bus)) keep(on_bus, static_cast<int32_t>(le(bytes.subspan(2, 4))));
  if (!operating()) return;
  const DriveState state = drive();
  if (state == DriveState::kFault || state == DriveState::kFaultReaction) return fail(ServoFault::kDriveFault);
  if (state != DriveState::kOperationEnabled) return fail(ServoFault::kDisabled);
  const bool turns = step_ == ServoStep::kTurn || step_ == ServoStep::kStop;
  if (turns && (status_ & kSlips) != 0) fail(ServoFault::kFollowingError);
}

void Servo::keep(const Stamp& on_bus, int32_t counts) {
  // The difference is right across the end of 32 bits.
  const auto step = static_cast<int32_t>(static_cast<uint32_t>(counts) - static_cast<uint32_t>(last_counts_));
  counts_ = counted_any_ ? counts_ + step : counts;
  counted_any_ = true;
  last_counts_ = counts;
  if (waiting_count_ == kWaiting) return;
  waiting_[(first_ + waiting_count_++) % kWaiting] = {on_bus, counts_,
                                                      angle_of(options_, static_cast<double>(counts_))};
}

bool Servo::next_position(ServoPosition& position) {
  if (waiting_count_ == 0) return false;
  position = waiting_[first_];
  first_ = (first_ + 1) % kWaiting;
  --waiting_count_;
  return true;
}

}  // namespace roomcal::drivers::cia402
