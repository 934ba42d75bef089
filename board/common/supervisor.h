#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "board/common/can_side.h"
#include "board/common/event_log.h"
#include "board/common/machine.h"
#include "board/common/options.h"
#include "board/common/panel.h"
#include "board/common/shared_stillness.h"
#include "board/common/start_counter.h"
#include "drivers/can/socketcan.h"
#include "drivers/iio/imu_stillness.h"
#include "runtime/console/console.h"
#include "runtime/face/answers.h"
#include "runtime/face/button_grammar.h"
#include "runtime/face/light_grammar.h"

namespace roomcal::board {

/// The loop that everything else hangs on: button, lamp, console, CAN, watchdog; starts presses and tells their
/// results. It never computes and never waits for longer than ten milliseconds, so it answers whatever the session
/// does.
///
/// The watchdogs are fed, and the lamp's alive flash blinks, only while every thread has answered.
class Supervisor final : public face::Desk {
 public:
  explicit Supervisor(const Options& options);

  /// Arms and serves until a signal or a reboot. A device that cannot be armed, or has crashed three times in a row,
  /// serves its console alone (safe mode).
  /// @return the exit status: 0 for an ordered end, 3 to be started again.
  int run();
  /// Arms and ends: for --check.
  int check();
  /// Arms and measures: for --bench.
  int bench();
  int print_memory_plan();

  Status start(press::Kind kind) override;
  Status abort() override;
  Status look(std::string_view sensor) override;
  Status selftest(std::string_view part, Reason& detail) override;
  Status reboot() override;
  void examine(face::Vitals& vitals) override;
  void read_log(std::size_t lines, void (*visit)(void* context, std::string_view line), void* context) override;
  int64_t unix_s() const override;

 private:
  void open_face();
  void open_can(const profile::Wiring& wiring);
  void open_imu(const profile::ImuWiring& wiring);
  ports::Stillness stillness();
  void make_answers();
  void round(int64_t now_ns);
  void wait(int64_t deadline_ns);
  void serve_button(int64_t now_ns);
  void raise_rights(int64_t now_ns);
  void act(face::Gesture gesture);
  void serve_console(int64_t now_ns);
  void serve_can(int64_t now_ns);
  void serve_imu(int64_t now_ns);
  void serve_light(int64_t now_ns);
  void serve_watchdogs(int64_t now_ns);
  void tell_progress(int64_t now_ns);
  void tell_result();
  void tell_sight();
  void restore_factory();
  bool threads_answer(int64_t now_ns) const;
  bool sensor_faulted();
  press::Moment moment();
  std::string state_file() const;

  Options options_;
  drivers::LinuxClocks clocks_;
  EventLog log_;
  drivers::LinuxFileKernel files_;
  drivers::LinuxCanKernel can_kernel_;
  drivers::SocketCan bus_;
  CanSide can_;
  std::string can_interface_;  ///< the bus keeps a pointer
  Machine machine_;
  Panel panel_;
  std::optional<drivers::ImuStillness> imu_;
  SharedStillness imu_stillness_;
  StartCounter starts_;

  std::array<std::byte, console::plan_console_bytes()> console_memory_{};
  Arena console_arena_;
  std::optional<face::Answers> answers_;
  console::Console console_;
  face::ButtonGrammar button_;
  console::Rights presence_ = console::Rights::kObserve;
  face::LightPlayer light_;
  face::Vitals vitals_;

  Reason trouble_;  ///< why it could not be armed
  bool safe_mode_ = false;
  int64_t begin_ns_ = 0;
  uint32_t told_presses_ = 0, told_looks_ = 0;
  press::Moment told_moment_;
  int64_t told_ns_ = 0;
  int64_t faulted_looked_ns_ = 0;
  bool faulted_ = false;
  int64_t lamp_test_until_ns_ = 0;
  int64_t reboot_at_ns_ = 0;
  bool hangs_ = false;    ///< a thread does not answer
  bool blocked_ = false;  ///< selftest watchdog: nobody is fed any more
};

/// SIGTERM and SIGINT end the loop in order.
void catch_signals();

}  // namespace roomcal::board
