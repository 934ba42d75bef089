#include "drivers/cia402/servo_fault.h"

#include <array>
#include <string_view>

#include "drivers/cia402/canopen.h"
#include "runtime/base/text_writer.h"

namespace roomcal::drivers::cia402 {

namespace {

constexpr std::array<const char*, static_cast<std::size_t>(ServoStep::kCount)> kSteps{"off",
                                                                                      "booting",
                                                                                      "being asked what it is",
                                                                                      "being set up",
                                                                                      "starting",
                                                                                      "being enabled",
                                                                                      "choosing homing",
                                                                                      "homing",
                                                                                      "choosing velocity mode",
                                                                                      "ready",
                                                                                      "turning",
                                                                                      "stopping",
                                                                                      "being switched off",
                                                                                      "faulted"};

struct FaultText {
  ServoFault fault;
  const char* name;
  const char* remedy;
};
constexpr std::array<FaultText, static_cast<std::size_t>(ServoFault::kCount)> kFaults{{
    {ServoFault::kNone, "no fault", ""},
    {ServoFault::kBusDown, "the CAN bus is down", "check wiring, bit rate and interface"},
    {ServoFault::kNoBoot, "it does not boot", "check its power, its node id and the bit rate"},
    {ServoFault::kNotADrive, "this node is no CiA 402 drive", "check the node id"},
    {ServoFault::kNoSuchMode, "it lacks profile velocity or homing mode", "choose another drive or firmware"},
    {ServoFault::kSdoTimeout, "it does not answer", "check its cable and power"},
    {ServoFault::kSdoAbort, "it refuses the set-up", "check the drive's manual and the options"},
    {ServoFault::kNotStarted, "it does not start", "check the drive's manual and the options"},
    {ServoFault::kNoPosition, "it does not answer SYNC with its position", "check its set-up and the bus load"},
    {ServoFault::kSyncLost, "our SYNC does not get onto the bus", "check the bus load and that somebody acknowledges"},
    {ServoFault::kHeartbeatLost, "heartbeat lost", "check its cable and power"},
    {ServoFault::kRebooted, "it rebooted", "check its power supply"},
    {ServoFault::kLeftOperation, "somebody stopped the node", "let no other CANopen master command it"},
    {ServoFault::kNotEnabled, "it cannot be enabled", "check power stage, enable input and limit switches"},
    {ServoFault::kDriveFault, "the drive reports a fault", "look it up in the drive's manual"},
    {ServoFault::kDisabled, "it was disabled", "check emergency stop and enable input"},
    {ServoFault::kModeRefused, "it does not take the mode", "check the drive's manual"},
    {ServoFault::kHomingFailed, "homing failed", "check the home switch and the homing method"},
    {ServoFault::kHomingTimeout, "homing does not end", "check the home switch and the homing speed"},
    {ServoFault::kFollowingError, "following error", "check that the table turns freely; lower speed or acceleration"},
    {ServoFault::kEmergency, "emergency", "look it up in the drive's manual"},
    {ServoFault::kNotStopped, "it does not stop", "press the emergency stop; check its deceleration"},
}};

constexpr bool in_order() {
  for (std::size_t i = 0; i < kFaults.size(); ++i)
    if (kFaults[i].fault != static_cast<ServoFault>(i)) return false;
  return true;
}
static_assert(in_order(), "one row a fault, in the order of ServoFault");

/// "6060h", as CANopen writes its numbers.
void add_hex(uint16_t value, TextWriter& line) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  for (int shift = 12; shift >= 0; shift -= 4) line.character(kDigits[value >> shift & 0xF]);
  line.character('h');
}

void add_facts(const FaultFacts& facts, TextWriter& line) {
  if (facts.fault == ServoFault::kSdoTimeout || facts.fault == ServoFault::kSdoAbort) {
    line.text(" (object ");
    add_hex(facts.object.index, line);
    line.text(" sub ").integer(facts.object.sub);
    if (facts.fault == ServoFault::kSdoAbort) line.text(": ").text(abort_name(facts.abort_code));
    line.text(")");
  }
  if (facts.fault == ServoFault::kNotEnabled || facts.fault == ServoFault::kDisabled)
    line.text(" (").text(to_string(facts.drive)).text(")");
  if (facts.emergency == 0) return;
  line.text(" (emergency ");
  add_hex(facts.emergency, line);
  line.text(": ").text(emergency_name(facts.emergency)).text(")");
}

}  // namespace

const char* to_string(ServoStep step) {
  return step < ServoStep::kCount ? kSteps[static_cast<std::size_t>(step)] : "lost";
}

const char* to_string(ServoFault fault) {
  return fault < ServoFault::kCount ? kFaults[static_cast<std::size_t>(fault)].name : "unknown fault";
}

Reason explain(uint8_t node, const FaultFacts& facts) {
  if (facts.fault == ServoFault::kNone || facts.fault >= ServoFault::kCount) return {};
  std::array<char, Reason::capacity()> buffer{};
  TextWriter line(buffer);
  line.text("servo node ").integer(node).text(", ").text(to_string(facts.step)).text(": ").text(to_string(facts.fault));
  add_facts(facts, line);
  line.text("; ").text(kFaults[static_cast<std::size_t>(facts.fault)].remedy);
  return Reason(line.view());
}

}  // namespace roomcal::drivers::cia402
