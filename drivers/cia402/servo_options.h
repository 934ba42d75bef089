#pragma once

#include <cstdint>

#include "drivers/cia402/sdo.h"
#include "runtime/base/fixed_vector.h"
#include "runtime/base/status.h"

namespace roomcal::drivers::cia402 {

/// One servo and what it turns. Angles, rates and accelerations are of the turntable, behind the gear.
struct ServoOptions {
  uint8_t node_id = 1;
  uint8_t own_id = 127;                 ///< of our heartbeat, which the servo supervises
  double counts_per_turn = 1'048'576;   ///< position units of object 6064h in one turn of the table; negative: reversed
  double velocity_units_per_count = 1;  ///< units of object 60FFh in one count a second, as the drive is set up
  double acceleration_units_per_count = 1;  ///< the same of objects 6083h, 6084h, 6085h
  double max_speed_radps = 3.2;             ///< turn() refuses more
  double acceleration_radps2 = 1;
  int8_t homing_method = 0;  ///< of object 6098h, by the drive's manual; 0: absolute encoder, no homing
  double homing_speed_radps = 0.2;
  int64_t homing_timeout_ns = 60'000'000'000;
  int64_t sync_period_ns = 10'000'000;
  int64_t sdo_timeout_ns = 500'000'000;
  int64_t heartbeat_period_ns = 100'000'000;  ///< of both sides; three are waited for
};

/// @return kInvalidArgument naming what cannot work.
Status check(const ServoOptions& options);

/// One write of the set-up.
struct SetupEntry {
  ObjectKey key;
  uint32_t value = 0;
  uint8_t bytes = 4;
  bool optional = false;  ///< some drives do not have it
};
using Setup = FixedVector<SetupEntry, 40>;

/// What is written before the node starts: heartbeats of both sides; RPDO1 = controlword and target velocity, taken at
/// once; TPDO1 = statusword and actual position at every SYNC; accelerations and homing. Order as CiA 301, 7.5.2.36,
/// asks: a PDO is switched off, mapped, and switched on again.
Setup setup_of(const ServoOptions& options);

inline constexpr ObjectKey kDeviceType{0x1000, 0}, kSupportedModes{0x6502, 0}, kModeOfOperation{0x6060, 0},
    kModeDisplay{0x6061, 0}, kControlword{0x6040, 0};

/// counts/s of a table's rate, and the other way round.
double counts_of(const ServoOptions& options, double angle_rad);
double angle_of(const ServoOptions& options, double counts);

}  // namespace roomcal::drivers::cia402
