// can_probe --interface IF [--seconds N] [--trigger] [--servo NODE] [--play-drive NODE] [--play-vehicle WORD,WORD...]
//
// Runs the CAN drivers on a real kernel: vcan or an emulated controller in a guest, or a bus on a desk. One JSON object
// a line on standard output: every message heard or confirmed, every second the state of bus, standstill and servo,
// every command. Sends CAL_STATUS as a device does, answers a calibrate command with CAL_RESULT, with --trigger fires
// CAL_TRIGGER every second. --servo powers a servo on, homes it and turns it; --play-drive plays such a servo and
// --play-vehicle a vehicle, for a second probe on the same bus: each WORD for two seconds, the last one for ever
// (standing, moving, repeating, damaged, silent). Exit 0 if the bus was up in the end, the servo without a fault.

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "drivers/can/protection.h"
#include "drivers/can/socketcan.h"
#include "drivers/can/standstill.h"
#include "drivers/can/station.h"
#include "drivers/cia402/servo.h"
#include "drivers/os/linux_clocks.h"
#include "tests/drivers/can/vehicle.h"
#include "tests/fakes/fake_servo_drive.h"

namespace {

using namespace roomcal;
using namespace roomcal::drivers;
using cia402::Servo;

constexpr int64_t kSecond_ns = 1'000'000'000;
constexpr int64_t kLoop_ns = 2'000'000;

struct Arguments {
  std::string interface;
  int seconds = 10;
  bool trigger = false;
  int servo = 0, drive = 0;  ///< node; 0: none
  std::vector<std::string> vehicle;
};

[[noreturn]] void complain(const std::string& what) {
  std::fprintf(stderr, "can_probe: %s; see the top of tests/guest/can_probe.cpp\n", what.c_str());
  std::exit(100);
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--trigger") {
      arguments.trigger = true;
      continue;
    }
    if (i + 1 == argc) complain(word + " needs a value");
    const std::string value = argv[++i];
    if (word == "--interface") {
      arguments.interface = value;
    } else if (word == "--seconds") {
      arguments.seconds = std::atoi(value.c_str());
    } else if (word == "--servo") {
      arguments.servo = std::atoi(value.c_str());
    } else if (word == "--play-drive") {
      arguments.drive = std::atoi(value.c_str());
    } else if (word == "--play-vehicle") {
      arguments.vehicle = words_of(value);
    } else {
      complain("what is " + word);
    }
  }
  if (arguments.interface.empty()) complain("give --interface");
  return arguments;
}

const char* to_string(Protection protection) {
  switch (protection) {
    case Protection::kGood:
      return "good";
    case Protection::kOtherLength:
      return "length";
    case Protection::kBadChecksum:
      return "checksum";
    case Protection::kBadCounter:
      return "counter";
  }
  return "?";
}

/// Prints every message of roomcal.dbc with its signals.
class Printer final : public CanListener {
 public:
  Printer() {
    for (std::size_t i = 0; i < ids_.size(); ++i) ids_[i] = {dbc::kMessages[i]->id, dbc::kMessages[i]->extended};
  }
  std::span<const CanId> ids() const override { return ids_; }
  void hear(const ports::CanMessage& message, const Arrival& arrival) override {
    for (const MessageLayout* layout : dbc::kMessages)
      if (layout->id == message.id) print(*layout, message, arrival);
  }

 private:
  static void print(const MessageLayout& layout, const ports::CanMessage& message, const Arrival& arrival) {
    std::printf("{\"message\":\"%s\",\"own\":%s,\"protection\":\"%s\",\"stamp_ns\":%" PRId64
                ",\"clock\":\"%s\",\"window_ms\":%.3f,\"signals\":{",
                layout.name, message.own ? "true" : "false", to_string(check_protection(layout, message)),
                message.stamp.ns, roomcal::to_string(message.stamp.clock),
                static_cast<double>(arrival.latest_ns - arrival.earliest_ns) * 1e-6);
    const char* comma = "";
    for (const Signal& signal : layout.signals) {
      const int64_t raw = raw_of(signal, message);
      const char* label = label_of(signal, raw);
      if (label != nullptr) {
        std::printf("%s\"%s\":\"%s\"", comma, signal.name, label);
      } else {
        std::printf("%s\"%s\":%.9g", comma, signal.name, value_of(signal, message));
      }
      comma = ",";
    }
    std::printf("}}\n");
  }

  std::array<CanId, dbc::kMessages.size()> ids_;
};

/// A vehicle that sends VEH_MOTION every 20 ms, and may do it badly.
class PlayedVehicle {
 public:
  PlayedVehicle(SocketCan& bus, std::vector<std::string> words) : bus_(bus), words_(std::move(words)) {}
  void tick(int64_t now_ns) {
    if (words_.empty() || now_ns < next_ns_) return;
    if (next_ns_ == 0) began_ns_ = now_ns;
    next_ns_ = now_ns + 20'000'000;
    const auto turn = static_cast<std::size_t>((now_ns - began_ns_) / (2 * kSecond_ns));
    const std::string& word = words_[std::min(turn, words_.size() - 1)];
    if (word == "silent") return;
    test::Motion motion;
    if (word == "moving") motion.standstill = dbc::veh_motion::Standstill::kMoving;
    ports::CanMessage message = test::motion_message(motion, counter_);
    if (word == "damaged") message.data[2] ^= 1;
    if (word != "repeating") counter_ = counter_after(counter_);
    static_cast<void>(bus_.send(message));
  }

 private:
  SocketCan& bus_;
  std::vector<std::string> words_;
  int64_t began_ns_ = 0, next_ns_ = 0;
  uint8_t counter_ = 0;
};

/// A servo's model on a real bus: hears everything that a node hears.
class PlayedDrive final : public CanListener, fakes::CanWire {
 public:
  PlayedDrive(SocketCan& bus, const LinuxClocks& clocks, uint8_t node)
      : bus_(bus),
        drive_(*this, clocks, node),
        ids_{{{cia402::kNmtId, false},
              {cia402::kSyncId, false},
              {cia402::rpdo1_id(node), false},
              {cia402::sdo_request_id(node), false},
              {cia402::heartbeat_id(127), false}}} {}
  std::span<const CanId> ids() const override { return ids_; }
  void hear(const ports::CanMessage& message, const Arrival&) override {
    if (!message.own) drive_.on_bus(message);
  }
  void tick() { drive_.tick(); }
  double position() const { return drive_.position_counts(); }

 private:
  void deliver(ports::CanMessage message, int64_t) override { static_cast<void>(bus_.send(message)); }

  SocketCan& bus_;
  fakes::FakeServoDrive drive_;
  std::array<CanId, 5> ids_;
};

class Probe {
 public:
  explicit Probe(const Arguments& arguments)
      : arguments_(arguments),
        standstill_(bus_, {.bus_name = arguments.interface.c_str()}),
        vehicle_(bus_, arguments.vehicle) {
    add(printer_);
    add(station_);
    add(standstill_);
    if (arguments.servo != 0) {
      servo_ = std::make_unique<Servo>(
          bus_, clocks_, cia402::ServoOptions{.node_id = static_cast<uint8_t>(arguments.servo), .homing_method = 17});
      add(*servo_);
    }
    if (arguments.drive != 0) {
      drive_ = std::make_unique<PlayedDrive>(bus_, clocks_, static_cast<uint8_t>(arguments.drive));
      add(*drive_);
    }
  }

  int run() {
    const Status started = bus_.start({arguments_.interface.c_str(), dispatcher_.ids()});
    if (!started.ok()) std::fprintf(stderr, "can_probe: %s (errno %d)\n", started.detail(), bus_.error_number());
    if (servo_) servo_->power_on();
    const int64_t began_ns = clocks_.now_ns();
    int64_t next_second_ns = began_ns + kSecond_ns;
    while (clocks_.now_ns() < began_ns + arguments_.seconds * kSecond_ns) {
      turn_once();
      if (clocks_.now_ns() < next_second_ns) continue;
      next_second_ns += kSecond_ns;
      each_second();
    }
    const bool up = bus_.state() != ports::CanState::kDown && bus_.state() != ports::CanState::kBusOff;
    return up && (!servo_ || servo_->reason().empty()) ? 0 : 1;
  }

 private:
  void add(CanListener& listener) {
    if (const Status added = dispatcher_.add(listener); !added.ok()) complain(added.detail());
  }

  void turn_once() {
    clocks_.sleep_until(clocks_.now_ns() + kLoop_ns);
    dispatcher_.poll();
    const ports::Stillness stillness = standstill_.look(clocks_.now_ns());
    if (stillness.still != still_ || std::string(stillness.why.view()).substr(0, 24) != why_.substr(0, 24))
      print_stillness(stillness);
    status_.stationary = stillness.still;
    station_.set_status(status_);
    station_.poll();
    for (CalCommand command; station_.next_command(command);) obey(command);
    if (drive_) drive_->tick();
    vehicle_.tick(clocks_.now_ns());
    if (!servo_) return;
    servo_->poll();
    if (servo_->ready()) static_cast<void>(servo_->turn(0.5));
    for (cia402::ServoPosition at; servo_->next_position(at); last_ = at) ++positions_;
  }

  void print_stillness(const ports::Stillness& stillness) {
    still_ = stillness.still;
    why_ = std::string(stillness.why.view());
    std::printf("{\"still\":%s,\"why\":\"%s\"}\n", still_ ? "true" : "false", why_.c_str());
  }

  void obey(const CalCommand& command) {
    const auto raw = static_cast<int64_t>(command.command);
    std::printf("{\"command\":\"%s\"}\n", label_of(dbc::cal_cmd::kCommand, raw));
    if (command.command != dbc::cal_cmd::Command::kCalibrate) return;
    station_.announce({.verdict = still_ ? Verdict::kPass : Verdict::kFailRetry,
                       .sensors_done = 5,
                       .sensors_wanted = 5,
                       .rms_px = 0.123,
                       .generation = ++generation_});
  }

  void each_second() {
    if (arguments_.trigger) static_cast<void>(station_.fire());
    const ports::CanCounters& c = bus_.counters();
    std::printf("{\"state\":\"%s\",\"fd\":%s,\"received\":%" PRIu64 ",\"sent\":%" PRIu64 ",\"refused\":%" PRIu64
                ",\"drops\":%" PRIu64 ",\"errors\":%" PRIu64 ",\"bus_offs\":%" PRIu64
                ",\"still\":%s,\"trouble\":\"%s\",\"errno\":%d}\n",
                ports::to_string(bus_.state()), bus_.carries_fd() ? "true" : "false", c.received, c.sent,
                c.send_refused, c.kernel_drops, c.error_messages, c.bus_offs, still_ ? "true" : "false",
                bus_.trouble().detail(), bus_.error_number());
    if (servo_) print_servo();
    if (drive_) std::printf("{\"played_counts\":%.1f}\n", drive_->position());
    std::fflush(stdout);
  }

  void print_servo() {
    const cia402::SyncCounters& s = servo_->sync_counters();
    std::printf("{\"servo\":\"%s\",\"reason\":\"%s\",\"positions\":%d,\"angle_rad\":%.6f,\"stamp_ns\":%" PRId64
                ",\"syncs\":%" PRIu64 ",\"unanswered\":%" PRIu64 ",\"unasked\":%" PRIu64 "}\n",
                to_string(servo_->step()), std::string(servo_->reason().view()).c_str(), positions_, last_.angle_rad,
                last_.on_bus.ns, s.confirmed, s.unanswered, s.unasked);
  }

  const Arguments& arguments_;
  LinuxCanKernel kernel_;
  LinuxClocks clocks_;
  SocketCan bus_{kernel_, clocks_};
  Dispatcher dispatcher_{bus_, clocks_};
  Printer printer_;
  Station station_{bus_, clocks_, static_cast<uint32_t>(clocks_.now_ns())};
  VehicleStandstill standstill_;
  PlayedVehicle vehicle_;
  std::unique_ptr<Servo> servo_;
  std::unique_ptr<PlayedDrive> drive_;
  CalStatus status_{.state = dbc::cal_status::State::kIdle};
  uint64_t generation_ = 0;
  bool still_ = true;
  std::string why_;
  int positions_ = 0;
  cia402::ServoPosition last_;
};

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = parse(argc, argv);
  return Probe(arguments).run();
}
