#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "tests/fakes/fake_can_bus.h"

namespace roomcal::fakes {

/// What is wrong with the drive. All as it should be unless told otherwise.
struct DriveTrouble {
  bool mute = false;                  ///< as if its cable were cut
  bool no_sdo = false;                ///< answers no SDO request
  int lose_sdo = 0;                   ///< so many SDO answers are lost
  uint16_t refuse_index = 0;          ///< SDO aborts every access to this object...
  uint32_t refuse_code = 0x08000022;  ///< ... for this reason
  uint32_t device_type = 0x00020192;
  uint32_t modes = 0x25;  ///< profile position, profile velocity, homing
  bool no_heartbeat = false;
  bool ignores_start = false;
  bool no_tpdo = false;
  bool double_tpdo = false;
  bool stuck_disabled = false;  ///< never leaves switch-on disabled: no enable input
  bool faulty = false;          ///< boots into a fault
  bool fault_stays = false;     ///< a reset does not help
  bool mode_stays = false;      ///< 6061h never shows another mode
  bool homing_fails = false;
  bool homing_hangs = false;
  bool slips = false;         ///< while it turns
  bool never_stands = false;  ///< creeps on when told to stop
};

/// A CiA 402 servo on a CANopen bus, by CiA 301 and CiA 402-2, written apart from the client: NMT, heartbeats both
/// ways, expedited SDO with an object dictionary that minds the order of PDO set-up, SYNC, one PDO each way, homing and
/// profile velocity with ramps. Moves as the clocks go on.
class FakeServoDrive final : public CanNode {
 public:
  FakeServoDrive(CanWire& wire, const ports::SystemClocks& clocks, uint8_t node);

  void on_bus(const ports::CanMessage& message) override;
  /// Time has passed.
  void tick();

  // What can happen to a drive.
  void emergency(uint16_t code);
  void break_down(uint16_t code);  ///< emergency, and the fault state
  void reboot();
  void lose_enable();        ///< emergency stop pressed
  void leave_operational();  ///< another master stops the node
  void send_statusword_late(int64_t late_ns) { tpdo_late_ns_ = late_ns; }

  double position_counts() const { return position_; }
  double velocity_counts() const { return velocity_; }
  bool enabled() const { return state_ == State::kEnabled; }
  bool told_to_stop() const { return (control_ & 0x0F) == 0x02; }
  uint16_t control() const { return control_; }
  int64_t homed_at() const { return homed_; }
  bool missed_master() const { return missed_master_; }
  /// (time of the SYNC on the bus, realtime ns; true position) of every answered SYNC.
  const std::vector<std::pair<int64_t, double>>& latched() const { return latched_; }
  uint32_t object(uint16_t index, uint8_t sub) const;

  DriveTrouble trouble;

 private:
  enum class State : uint8_t { kNotReady, kDisabled, kReady, kSwitchedOn, kEnabled, kQuickStop, kFault };
  using Key = std::pair<uint16_t, uint8_t>;

  void boot(bool whole_node);
  void hear_nmt(const ports::CanMessage& message);
  void hear_sdo(const ports::CanMessage& message);
  uint32_t write(Key key, uint32_t value);
  void hear_command(const ports::CanMessage& message);
  void hear_sync(const ports::CanMessage& message);
  void follow_command(uint16_t before);
  void move(double seconds);
  void step_homing(double seconds);
  uint16_t statusword() const;
  void answer(uint32_t id, std::vector<uint8_t> bytes, int64_t after_ns = 150'000);
  bool pdo_is_off(uint16_t communication) const { return (object(communication, 1) & 0x80000000) != 0; }
  bool operational() const { return nmt_ == 0x05; }

  CanWire& wire_;
  const ports::SystemClocks& clocks_;
  uint8_t node_;
  std::map<Key, uint32_t> objects_;
  uint8_t nmt_ = 0;
  State state_ = State::kNotReady;
  uint16_t control_ = 0;
  int32_t target_ = 0;
  int8_t mode_ = 0;
  double position_ = 12'345, velocity_ = 0;
  bool homing_ = false;
  double homing_left_s_ = 0;
  bool homing_done_ = false, homing_error_ = false;
  int64_t homed_ = 0;
  int64_t last_ns_, boots_at_ns_, next_heartbeat_ns_ = 0, master_heard_ns_ = -1;
  bool booting_ = true, missed_master_ = false;
  int64_t tpdo_late_ns_ = 0;
  std::vector<std::pair<int64_t, double>> latched_;
};

}  // namespace roomcal::fakes
