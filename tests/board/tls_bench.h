#pragma once

#include <atomic>
#include <functional>
#include <memory>

#include "board/common/machine.h"
#include "drivers/os/thread.h"
#include "tests/board/board_folder.h"
#include "tests/fakes/fake_can_bus.h"
#include "tests/fakes/fake_servo_drive.h"

namespace roomcal::board::test {

class TlsWorld;

/// The terrestrial scanner as a device, armed: a CiA 402 drive on the bus turns a profiler whose packets come by UDP
/// from a room, two still cameras show the same room. The world around it, and the supervisor's part of the bus, is a
/// thread of its own.
class TlsBench {
 public:
  /// @param half_turn_s  of the table for a sweep. @param haste  how much more than asked for the drive accelerates.
  /// @param in_world  called first by the world's thread.
  explicit TlsBench(double half_turn_s, double haste = 1, std::function<void()> in_world = {});
  ~TlsBench();

  /// Why it could not be armed; empty if it was.
  const Reason& trouble() const { return trouble_; }
  Machine& machine() { return *machine_; }
  const tools::Stand& stand() const { return folder_.stand(); }
  /// A whole press, 90 s at the most.
  const press::Report& press(press::Kind kind);

 private:
  void prepare(double half_turn_s, double haste);
  void arm(std::function<void()> in_world);

  BoardFolder folder_;
  drivers::LinuxClocks clocks_;
  EventLog log_;
  fakes::FakeCanBus bus_;
  fakes::FakeServoDrive drive_;
  CanSide can_;
  std::unique_ptr<Machine> machine_;
  std::unique_ptr<TlsWorld> world_;
  drivers::Thread thread_;
  Reason trouble_;
};

}  // namespace roomcal::board::test
