#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "drivers/can/dispatcher.h"
#include "drivers/can/protection.h"
#include "runtime/ports/stillness_sensor.h"

namespace roomcal::drivers {

struct StandstillOptions {
  const char* bus_name = "can0";  ///< for messages; kept
  int64_t max_age_ns = 150'000'000;
  int64_t settle_ns = 150'000'000;  ///< of good messages after any doubt
  uint8_t good_in_a_row = 3;
  double max_speed_mps = 0.01;        ///< a wheel encoder's last step; 0.1 mm in the 10 ms of an exposure
  double max_yaw_rate_radps = 0.005;  ///< noise of a car's rate gyro; 0.05 mrad in the 10 ms of an exposure
  bool needs_park_brake = false;      ///< true: only with the parking brake applied
};

/// What speaks against standstill.
enum class Doubt : uint8_t {
  kNothingHeard,
  kBusDown,      ///< not there, not up, bus-off, or it was meanwhile
  kStopped,      ///< too long without a message
  kBadChecksum,  ///< or bad length or counter
  kRepeated,     ///< the counter stands still
  kSkipped,      ///< the counter jumps: messages were lost, or come from two senders
  kSaysMoving,   ///< the sender does not say that it stands
  kSpeedUnknown,
  kSpeed,
  kYawRate,
  kParkBrake,
  kCount
};

/// Whether the vehicle says that it stands still (VEH_MOTION of roomcal.dbc).
///
/// It does only after three good messages in a row, and while the last of them is younger than 150 ms: checksum right,
/// counter one further than before, flag set, speed and yaw rate below their limits, bus up. Everything else is motion,
/// and motion for 150 ms longer than it lasts. All figures are options.
class VehicleStandstill final : public ports::StillnessSensor, public CanListener {
 public:
  /// @param bus  for its state; outlives the sensor.
  VehicleStandstill(const ports::CanBus& bus, const StandstillOptions& options) : bus_(bus), options_(options) {}

  std::span<const CanId> ids() const override;
  void hear(const ports::CanMessage& message, const Arrival& arrival) override;
  ports::Stillness look(int64_t now_ns) override;

  /// Of the last look() that said moving.
  Doubt doubt() const { return doubt_; }

 private:
  bool bus_down() const;
  void watch_bus(int64_t now_ns);
  Doubt gap_before(const ports::CanMessage& message, const Arrival& arrival) const;
  Doubt objection(const ports::CanMessage& message);
  void doubt_it(Doubt doubt, int64_t at_ns);
  Reason explain(int64_t now_ns) const;

  const ports::CanBus& bus_;
  StandstillOptions options_;
  bool heard_ = false;    ///< a message with a right checksum
  bool chained_ = false;  ///< and no damaged one since: the next counter is known
  uint8_t counter_ = 0;
  uint8_t good_ = 0;                                              ///< in a row
  Arrival last_;                                                  ///< of the last message with a right checksum
  int64_t doubted_ns_ = std::numeric_limits<int64_t>::min() / 2;  ///< when there was doubt for the last time
  Doubt doubt_ = Doubt::kNothingHeard;
  double speed_mps_ = 0, yaw_rate_radps_ = 0;
  uint64_t bus_offs_ = 0;
};

}  // namespace roomcal::drivers
