#include "drivers/can/standstill.h"

#include <algorithm>
#include <cmath>

#include "drivers/can/roomcal_dbc_generated.h"
#include "runtime/base/text_writer.h"

namespace roomcal::drivers {

namespace motion = dbc::veh_motion;

namespace {

constexpr std::array<CanId, 1> kIds{{{motion::kLayout.id, motion::kLayout.extended}}};

bool is(const Signal& signal, int64_t raw, const ports::CanMessage& message) { return raw_of(signal, message) == raw; }

struct DoubtText {
  Doubt doubt;
  const char* before;      ///< the figure
  const char* after = "";  ///< empty: there is no figure
};
constexpr std::array<DoubtText, static_cast<std::size_t>(Doubt::kCount)> kTexts{{
    {Doubt::kNothingHeard, "waits for VEH_MOTION; let the vehicle send it"},
    {Doubt::kBusDown, "the bus is or was ", "; check wiring, bit rate and interface"},
    {Doubt::kStopped, "VEH_MOTION stays away for ", " ms; check the vehicle's controller and the cable"},
    {Doubt::kBadChecksum, "VEH_MOTION fails its checksum; check the sender's DataId and layout, and the cable"},
    {Doubt::kRepeated, "VEH_MOTION repeats its counter; check the vehicle's controller"},
    {Doubt::kSkipped, "the counter of VEH_MOTION jumps; check the bus load, and that only one sends it"},
    {Doubt::kSaysMoving, "the vehicle does not say that it stands; stop it"},
    {Doubt::kSpeedUnknown, "the vehicle does not know its speed; check its wheel sensors"},
    {Doubt::kSpeed, "the vehicle moves at ", " m/s; stop it"},
    {Doubt::kYawRate, "the vehicle turns at ", " rad/s; stop it"},
    {Doubt::kParkBrake, "the parking brake is not applied; apply it"},
}};

constexpr bool in_order() {
  for (std::size_t i = 0; i < kTexts.size(); ++i)
    if (kTexts[i].doubt != static_cast<Doubt>(i)) return false;
  return true;
}
static_assert(in_order(), "one row a doubt, in the order of Doubt");

}  // namespace

std::span<const CanId> VehicleStandstill::ids() const { return kIds; }

bool VehicleStandstill::bus_down() const {
  return bus_.state() == ports::CanState::kDown || bus_.state() == ports::CanState::kBusOff;
}

void VehicleStandstill::doubt_it(Doubt doubt, int64_t at_ns) {
  good_ = 0;
  doubt_ = doubt;
  doubted_ns_ = std::max(doubted_ns_, at_ns);
}

void VehicleStandstill::watch_bus(int64_t now_ns) {
  const uint64_t bus_offs = bus_.counters().bus_offs;
  if (bus_down() || bus_offs != bus_offs_) doubt_it(Doubt::kBusDown, now_ns);
  bus_offs_ = bus_offs;
}

/// What is wrong between the message before and this one. @return kCount: nothing.
Doubt VehicleStandstill::gap_before(const ports::CanMessage& message, const Arrival& arrival) const {
  if (!heard_) return Doubt::kNothingHeard;
  if (arrival.latest_ns - last_.earliest_ns > options_.max_age_ns) return Doubt::kStopped;
  if (!chained_ || counter_of(message) == counter_after(counter_)) return Doubt::kCount;
  return counter_of(message) == counter_ ? Doubt::kRepeated : Doubt::kSkipped;
}

/// What is wrong with what it says. @return kCount: nothing.
Doubt VehicleStandstill::objection(const ports::CanMessage& message) {
  speed_mps_ = value_of(motion::kSpeed, message);
  yaw_rate_radps_ = value_of(motion::kYawRate, message);
  const bool measures_yaw = !is(motion::kYawRate, static_cast<int64_t>(motion::YawRate::kNotMeasured), message);
  if (!is(motion::kStandstill, static_cast<int64_t>(motion::Standstill::kStanding), message)) return Doubt::kSaysMoving;
  if (is(motion::kSpeed, static_cast<int64_t>(motion::Speed::kUnknown), message)) return Doubt::kSpeedUnknown;
  if (std::abs(speed_mps_) > options_.max_speed_mps) return Doubt::kSpeed;
  if (measures_yaw && std::abs(yaw_rate_radps_) > options_.max_yaw_rate_radps) return Doubt::kYawRate;
  if (options_.needs_park_brake && !is(motion::kParkBrake, static_cast<int64_t>(motion::ParkBrake::kApplied), message))
    return Doubt::kParkBrake;
  return Doubt::kCount;
}

void VehicleStandstill::hear(const ports::CanMessage& message, const Arrival& arrival) {
  watch_bus(arrival.latest_ns);
  if (check_protection(motion::kLayout, message) != Protection::kGood) {
    chained_ = false;
    return doubt_it(Doubt::kBadChecksum, arrival.latest_ns);
  }
  const Doubt gap = gap_before(message, arrival), content = objection(message);
  heard_ = chained_ = true;
  counter_ = counter_of(message);
  last_ = arrival;
  if (content != Doubt::kCount) return doubt_it(content, arrival.latest_ns);
  if (gap != Doubt::kCount) return doubt_it(gap, arrival.latest_ns);
  good_ = static_cast<uint8_t>(std::min(255, good_ + 1));
}

ports::Stillness VehicleStandstill::look(int64_t now_ns) {
  watch_bus(now_ns);
  if (heard_ && !bus_down() && now_ns - last_.earliest_ns > options_.max_age_ns) doubt_it(Doubt::kStopped, now_ns);
  if (good_ >= options_.good_in_a_row && now_ns - doubted_ns_ >= options_.settle_ns) return {true, {}};
  return {false, explain(now_ns)};
}

Reason VehicleStandstill::explain(int64_t now_ns) const {
  std::array<char, Reason::capacity()> buffer{};
  TextWriter line(buffer);
  const DoubtText& text = kTexts[static_cast<std::size_t>(doubt_)];
  line.text(options_.bus_name).text(": ").text(text.before);
  if (doubt_ == Doubt::kBusDown) line.text(to_string(bus_.state()));
  if (doubt_ == Doubt::kStopped) line.integer((now_ns - last_.earliest_ns) / 1'000'000);
  if (doubt_ == Doubt::kSpeed) line.fixed(speed_mps_, 3);
  if (doubt_ == Doubt::kYawRate) line.fixed(yaw_rate_radps_, 3);
  return Reason(line.text(text.after).view());
}

}  // namespace roomcal::drivers
