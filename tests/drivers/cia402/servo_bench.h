#pragma once

#include <functional>
#include <vector>

#include "drivers/can/dispatcher.h"
#include "drivers/cia402/servo.h"
#include "tests/fakes/fake_servo_drive.h"
#include "tests/fakes/manual_clocks.h"

namespace roomcal::drivers::cia402::test {

inline constexpr int64_t kMs = 1'000'000;

/// A servo client, a bus, a drive, and a loop of 1 kHz.
struct ServoBench {
  explicit ServoBench(const ServoOptions& with = {.node_id = 5, .homing_method = 17}) : options(with) {
    bus.attach(drive);
    static_cast<void>(dispatcher.add(servo));
  }

  void turn_once() {
    clocks.advance(kMs);
    if (before_each) before_each();
    drive.tick();
    dispatcher.poll();
    servo.poll();
    for (ServoPosition position; servo.next_position(position);) positions.push_back(position);
  }
  void run(int64_t ms) {
    for (int64_t i = 0; i < ms; ++i) turn_once();
  }
  /// @return whether it came there within so long.
  bool reach(ServoStep step, int64_t ms = 20'000) {
    for (int64_t i = 0; i < ms && servo.step() != step; ++i) turn_once();
    return servo.step() == step;
  }
  bool reach_any(ServoStep step) {
    if (servo.step() == ServoStep::kOff) servo.power_on();
    if (step <= ServoStep::kReady) return reach(step);
    const bool turned = reach(ServoStep::kReady) && servo.turn(1.0).ok();
    if (step == ServoStep::kStop) {
      run(500);
      servo.stop();
    }
    return turned && servo.step() == step;
  }

  ServoOptions options;
  fakes::ManualClocks clocks;
  fakes::FakeCanBus bus{clocks};
  fakes::FakeServoDrive drive{bus, clocks, 5};
  Dispatcher dispatcher{bus, clocks};
  Servo servo{bus, clocks, options};
  std::vector<ServoPosition> positions;
  std::function<void()> before_each;
};

}  // namespace roomcal::drivers::cia402::test
