// What runs on the bus' thread after arming makes no heap call: socket, dispatch, standstill, station, servo,
// turntable.

#include <algorithm>
#include <cerrno>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/can/socketcan.h"
#include "drivers/can/standstill.h"
#include "drivers/can/station.h"
#include "runtime/lidar/turntable.h"
#include "tests/budget/heap_guard.h"
#include "tests/drivers/can/vehicle.h"
#include "tests/drivers/cia402/servo_bench.h"
#include "tests/fakes/fake_can_kernel.h"
#include "tests/fakes/manual_clocks.h"

namespace roomcal::drivers {
namespace {

constexpr int64_t kMs = 1'000'000;

class CanHeap : public testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__)
    GTEST_SKIP() << "the sanitizer brings its own allocator";
#endif
  }
};

canfd_frame frame_of(const ports::CanMessage& message) {
  canfd_frame frame{};
  frame.can_id = message.id;
  frame.len = message.length;
  std::copy_n(message.data.begin(), 8, frame.data);
  return frame;
}

TEST_F(CanHeap, VehicleAndPanelOnABusThatFails_NoCall) {
  std::size_t calls = 0, looks = 0, still = 0, reasons = 0;
  {
    const budget::HeapGuard guard;
    fakes::FakeCanKernel kernel;
    fakes::ManualClocks clocks;
    SocketCan bus(kernel, clocks);
    Dispatcher dispatcher(bus, clocks);
    Station station(bus, clocks, 1);
    VehicleStandstill standstill(bus, {});
    static_cast<void>(dispatcher.add(station));
    static_cast<void>(dispatcher.add(standstill));
    static_cast<void>(bus.start({"can0", dispatcher.ids()}));
    uint8_t counter = 0;
    for (int i = 0; i < 3'000; ++i) {
      clocks.advance(10 * kMs);
      if (i % 700 == 600) kernel.unplug();
      if (i % 700 == 650) kernel.plug();
      if (i % 500 == 400) kernel.set_script({fakes::CanCall::kSend, 0, 20, ENOBUFS});
      kernel.arrive(frame_of(test::motion_message({}, counter)));
      counter = counter_after(counter);
      dispatcher.poll();
      station.poll();
      if (i % 100 == 0) station.announce({});
      if (i % 10 == 0) static_cast<void>(station.fire());
      const ports::Stillness stillness = standstill.look(clocks.now_ns());
      ++looks;
      still += stillness.still;
      reasons += stillness.why.view().size();
    }
    calls = guard.calls();
  }
  EXPECT_EQ(calls, 0U);
  EXPECT_GT(still, looks / 2);
  EXPECT_GT(reasons, 0U);
}

/// Hands over what another bus once handed over, at the same times.
class PlaybackBus final : public ports::CanBus {
 public:
  struct Item {
    int64_t at_ns = 0;
    ports::CanMessage message;
  };
  PlaybackBus(std::span<const Item> items, const fakes::ManualClocks& clocks) : items_(items), clocks_(clocks) {}
  Status send(const ports::CanMessage&) override { return ok_status(); }
  bool receive(ports::CanMessage& message) override {
    if (next_ == items_.size() || items_[next_].at_ns > clocks_.now_ns()) return false;
    message = items_[next_++].message;
    return true;
  }
  ports::CanState state() const override { return ports::CanState::kActive; }
  const ports::CanCounters& counters() const override { return counters_; }

 private:
  std::span<const Item> items_;
  const fakes::ManualClocks& clocks_;
  std::size_t next_ = 0;
  ports::CanCounters counters_;
};

/// Keeps everything that goes through it.
struct Recorder final : CanListener {
  std::span<const CanId> ids() const override { return wanted; }
  void hear(const ports::CanMessage& message, const Arrival& arrival) override {
    items.push_back({arrival.latest_ns, message});
  }
  std::span<const CanId> wanted;
  std::vector<PlaybackBus::Item> items;
};

TEST_F(CanHeap, ServoFromPowerOnToASweep_NoCall) {
  using cia402::Servo;
  using cia402::ServoStep;
  cia402::test::ServoBench bench;
  Recorder recorder;
  recorder.wanted = bench.servo.ids();
  ASSERT_TRUE(bench.dispatcher.add(recorder).ok());
  const int64_t begun_ns = bench.clocks.now_ns();
  ASSERT_TRUE(bench.reach_any(ServoStep::kTurn));
  bench.run(4'500);
  bench.drive.break_down(0x8611);
  bench.run(100);

  lidar::TurntableOptions options;
  options.capacity = 10'000;
  std::vector<std::byte> memory(lidar::Turntable::arena_bytes(options));
  const std::vector<lidar::SweepPoint> points(36);
  lidar::Sweep profile;
  profile.points = points;
  std::size_t calls = 0;
  bool whole = false;
  ServoStep last = ServoStep::kOff;
  fakes::ManualClocks clocks;
  clocks.advance(begun_ns - clocks.now_ns());
  {
    const budget::HeapGuard guard;
    Arena arena(memory);
    lidar::Turntable table = lidar::Turntable::create(options, arena).value();
    PlaybackBus bus(recorder.items, clocks);
    Dispatcher dispatcher(bus, clocks);
    Servo servo(bus, clocks, bench.options);
    static_cast<void>(dispatcher.add(servo));
    servo.power_on();
    while (clocks.now_ns() < bench.clocks.now_ns()) {
      clocks.advance(kMs);
      dispatcher.poll();
      servo.poll();
      if (servo.ready()) {
        table.begin();
        static_cast<void>(servo.turn(1));
      }
      for (cia402::ServoPosition at; servo.next_position(at);)
        static_cast<void>(table.add_angle({at.on_bus, at.angle_rad}));
      static_cast<void>(table.add_profile(profile, clocks.read(ClockId::kRealtime)));
      static_cast<void>(servo.reason());
    }
    whole = table.whole();
    table.finish();
    last = servo.step();
    calls = guard.calls();
  }
  EXPECT_EQ(calls, 0U);
  EXPECT_TRUE(whole);
  EXPECT_EQ(last, ServoStep::kFaulted);
}

}  // namespace
}  // namespace roomcal::drivers
