#pragma once

#include "drivers/can/protection.h"
#include "drivers/can/roomcal_dbc_generated.h"

namespace roomcal::drivers::test {

/// What a vehicle says of its motion; standing unless told otherwise.
struct Motion {
  dbc::veh_motion::Standstill standstill = dbc::veh_motion::Standstill::kStanding;
  dbc::veh_motion::ParkBrake brake = dbc::veh_motion::ParkBrake::kReleased;
  double speed_mps = 0;
  double yaw_rate_radps = 0;
};

inline ports::CanMessage motion_message(const Motion& motion, uint8_t counter) {
  namespace veh = dbc::veh_motion;
  ports::CanMessage message = blank(veh::kLayout);
  put_label(veh::kStandstill, motion.standstill, message);
  put_label(veh::kParkBrake, motion.brake, message);
  put_clamped(veh::kSpeed, motion.speed_mps, message);
  put_clamped(veh::kYawRate, motion.yaw_rate_radps, message);
  protect(veh::kLayout, counter, message);
  return message;
}

}  // namespace roomcal::drivers::test
