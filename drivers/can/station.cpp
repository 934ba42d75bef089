#include "drivers/can/station.h"

#include <algorithm>
#include <cmath>

#include "drivers/can/protection.h"

namespace roomcal::drivers {

namespace {

namespace command = dbc::cal_cmd;
namespace status = dbc::cal_status;
namespace result = dbc::cal_result;
namespace trigger = dbc::cal_trigger;
namespace trigger_in = dbc::cal_trigger_in;

constexpr int64_t kStatusPeriod_ns = int64_t{status::kLayout.cycle_ms} * 1'000'000;
constexpr int64_t kNonceLife_ns = 1'000'000'000;
constexpr int64_t kRepeat_ns = 100'000'000, kGiveUp_ns = 5'000'000'000;
constexpr uint32_t kNonceMask = (1U << command::kNonce.bits) - 1;

constexpr CanId id_of(const MessageLayout& layout) { return {layout.id, layout.extended}; }
constexpr std::array<CanId, 5> kIds{id_of(command::kLayout), id_of(status::kLayout), id_of(result::kLayout),
                                    id_of(trigger::kLayout), id_of(trigger_in::kLayout)};

static_assert(static_cast<int>(result::Verdict::kPass) == static_cast<int>(Verdict::kPass) &&
                  static_cast<int>(result::Verdict::kPassAdvise) == static_cast<int>(Verdict::kPassAdvise) &&
                  static_cast<int>(result::Verdict::kFailRetry) == static_cast<int>(Verdict::kFailRetry) &&
                  static_cast<int>(result::Verdict::kFailService) == static_cast<int>(Verdict::kFailService),
              "the DBC file numbers verdicts as the runtime does");

// Visits all 2^24 values before it repeats one (Hull, Dobell 1962: odd increment, multiplier 1 modulo 4).
uint32_t nonce_after(uint32_t nonce) { return (1'664'525U * nonce + 1'013'904'223U) & kNonceMask; }

template <typename T, std::size_t kCapacity>
bool take_first(FixedVector<T, kCapacity>& queue, T& first) {
  if (queue.empty()) return false;
  first = queue[0];
  std::copy(queue.begin() + 1, queue.end(), queue.begin());
  queue.pop_back();
  return true;
}

}  // namespace

Station::Station(ports::CanBus& bus, const ports::Clock& clock, uint32_t seed)
    : bus_(bus),
      clock_(clock),
      next_status_ns_(clock.now_ns()),
      next_nonce_ns_(next_status_ns_ + kNonceLife_ns),
      nonce_(nonce_after(seed)),
      nonce_before_(nonce_) {}

std::span<const CanId> Station::ids() const { return kIds; }

void Station::poll() {
  const int64_t now_ns = clock_.now_ns();
  if (now_ns >= next_nonce_ns_) renew_nonce(now_ns);
  if (result_.waits && now_ns >= result_.next_ns) repeat_result(now_ns);
  if (now_ns < next_status_ns_) return;
  send_status();
  // In step with the period, unless whole periods were missed.
  next_status_ns_ += kStatusPeriod_ns;
  if (next_status_ns_ <= now_ns) next_status_ns_ = now_ns + kStatusPeriod_ns;
}

void Station::renew_nonce(int64_t now_ns) {
  nonce_before_ = nonce_;
  nonce_ = nonce_after(nonce_);
  next_nonce_ns_ = now_ns + kNonceLife_ns;
}

void Station::send_status() {
  ports::CanMessage message = blank(status::kLayout);
  put_label(status::kState, status_.state, message);
  put_label(status::kStep, status_.step, message);
  put_clamped(status::kProgress, std::floor(status_.progress_percent), message);
  put_label(status::kReason, status_.reason, message);
  put_raw(status::kStationary, status_.stationary ? 1 : 0, message);
  put_label(status::kStore, status_.store, message);
  put_label(status::kCommandAnswer, answer_, message);
  put_raw(status::kNonce, nonce_, message);
  protect(status::kLayout, status_counter_, message);
  status_counter_ = counter_after(status_counter_);
  ++(bus_.send(message).ok() ? counters_.status_sent : counters_.status_refused);
}

void Station::announce(const CalResult& told) {
  ports::CanMessage message = blank(result::kLayout);
  const auto verdict = told.aborted ? result::Verdict::kAborted : static_cast<result::Verdict>(told.verdict);
  put_label(result::kVerdict, verdict, message);
  put_label(result::kKind, told.verify_only ? result::Kind::kVerify : result::Kind::kCalibrate, message);
  put_clamped(result::kSensorsDone, static_cast<double>(told.sensors_done), message);
  put_clamped(result::kSensorsWanted, static_cast<double>(told.sensors_wanted), message);
  put_clamped(result::kRms, told.rms_px, message);
  put_raw(result::kGeneration, static_cast<int64_t>(told.generation & 0xFFFFFF), message);
  protect(result::kLayout, result_counter_, message);
  result_counter_ = counter_after(result_counter_);
  if (result_.waits) ++counters_.results_given_up;
  const int64_t now_ns = clock_.now_ns();
  result_ = {true, message, now_ns, now_ns + kGiveUp_ns};
  repeat_result(now_ns);
}

/// The same bytes again: a listener that got it before sees its counter repeated.
void Station::repeat_result(int64_t now_ns) {
  if (now_ns >= result_.until_ns) {
    result_.waits = false;
    ++counters_.results_given_up;
    return;
  }
  static_cast<void>(bus_.send(result_.message));  // refused ones come again as those that were not confirmed
  result_.next_ns = now_ns + kRepeat_ns;
}

Status Station::fire() {
  ports::CanMessage message = blank(trigger::kLayout);
  put_raw(trigger::kTriggerId, trigger_id_, message);
  put_raw(trigger::kStamp, clock_.now_ns() / 1000, message);
  protect(trigger::kLayout, trigger_counter_, message);
  ROOMCAL_TRY(bus_.send(message));
  ++trigger_id_;
  trigger_counter_ = counter_after(trigger_counter_);
  return ok_status();
}

bool Station::last_fired(TriggerMark& mark) const {
  if (fired_any_) mark = fired_;
  return fired_any_;
}

bool Station::next_command(CalCommand& first) { return take_first(commands_, first); }
bool Station::next_mark(TriggerMark& mark) { return take_first(marks_, mark); }

void Station::hear(const ports::CanMessage& message, const Arrival& arrival) {
  if (message.own) return hear_own(message);
  if (message.id == command::kLayout.id) hear_command(message, arrival);
  if (message.id == trigger_in::kLayout.id) hear_mark(message);
}

void Station::hear_own(const ports::CanMessage& message) {
  if (message.id == result::kLayout.id && result_.waits && message.data == result_.message.data) {
    result_.waits = false;
    ++counters_.results_sent;
  }
  if (message.id != trigger::kLayout.id) return;
  fired_any_ = true;
  fired_ = {static_cast<uint8_t>(raw_of(trigger::kTriggerId, message)), value_of(trigger::kStamp, message),
            message.stamp};
}

void Station::hear_command(const ports::CanMessage& message, const Arrival& arrival) {
  if (check_protection(command::kLayout, message) != Protection::kGood) {
    ++counters_.damaged;
    return;
  }
  const int64_t wanted = raw_of(command::kCommand, message);
  const auto nonce = static_cast<uint32_t>(raw_of(command::kNonce, message));
  if (wanted == static_cast<int64_t>(command::Command::kNone)) return;
  if (took_any_ && nonce == taken_nonce_) {
    ++counters_.repeated;
  } else if (nonce != nonce_ && nonce != nonce_before_) {
    ++counters_.stale;
    answer_ = status::CommandAnswer::kStaleNonce;
  } else if (label_of(command::kCommand, wanted) == nullptr) {
    ++counters_.unknown_commands;
    answer_ = status::CommandAnswer::kUnknownCommand;
  } else if (!commands_.push_back({static_cast<command::Command>(wanted), arrival})) {
    ++counters_.crowded_out;
    answer_ = status::CommandAnswer::kBusy;
  } else {
    ++counters_.commands;
    answer_ = status::CommandAnswer::kTaken;
    took_any_ = true;
    taken_nonce_ = nonce;
    // Neither of the two nonces opens the door a second time.
    renew_nonce(arrival.latest_ns);
    nonce_before_ = nonce_;
  }
}

void Station::hear_mark(const ports::CanMessage& message) {
  if (check_protection(trigger_in::kLayout, message) != Protection::kGood) {
    ++counters_.damaged;
    return;
  }
  const TriggerMark mark{static_cast<uint8_t>(raw_of(trigger_in::kTriggerId, message)),
                         value_of(trigger_in::kStamp, message), message.stamp};
  if (!marks_.push_back(mark)) ++counters_.crowded_out;
}

}  // namespace roomcal::drivers
