#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <optional>

#include "runtime/base/arena.h"
#include "runtime/calib/observer.h"
#include "runtime/calib/outcome.h"
#include "runtime/calib/session.h"
#include "runtime/calib/to_record.h"
#include "runtime/grab/grabber.h"
#include "runtime/ports/system_clocks.h"
#include "runtime/ports/thermometer.h"
#include "runtime/press/state.h"
#include "runtime/store/store.h"

namespace roomcal::press {

/// What one press came to; complete whatever happened.
struct Report {
  Kind kind = Kind::kVerify;
  Result result = Result::kNone;
  Trouble trouble = Trouble::kNone;
  FixedVector<Reason, calib::kMaxReasons> reasons;  ///< one line each, that names the thing and what to do
  bool stored = false;                              ///< it is in force, and survives any power cut
  uint64_t generation = 0;                          ///< of the record that was written
  int64_t measured_unix_s = 0;
  double temperature_c = std::numeric_limits<double>::quiet_NaN();  ///< at the grab; NaN: not known
  int64_t spread_ns = 0;                                            ///< of the exposures
  int64_t spread_uncertainty_ns = 0;
  std::size_t tries = 0;  ///< shots that were taken until the device stood still
  int64_t grab_ns = 0, compute_ns = 0, write_ns = 0, total_ns = 0;
};

/// A moment of a press, for bars and lamps. Progress never goes back.
struct Moment {
  State state = State::kIdle;
  uint8_t percent = 0;
};

/// All that a press works with; everything outlives it.
struct Parts {
  calib::Session& session;
  grab::Grabber& grabber;
  store::Store& store;
  Arenas& arenas;
  const ports::SystemClocks& clocks;
  store::LongId firmware_id;
  store::Serial device_serial;
  std::atomic<int64_t>* alive_ns = nullptr;   ///< set to now at every step, for the watchdog; null: nobody asks
  ports::Thermometer* thermometer = nullptr;  ///< null: there is none
  store::Serial trigger;                      ///< what makes the cameras expose, for the record
};

/// One press of the button, from standing still to the store.
///
///     still -> grab -> detect .. judge -> store -> check
///
/// run() belongs to the session's thread, now() and abort() to any. begin() and what report() and outcome() give belong
/// to whoever starts presses, while nothing runs. No heap.
class Press final : public grab::GrabWatcher, public calib::Observer {
 public:
  explicit Press(const Parts& parts) : parts_(parts) {}

  /// Before the session's thread is asked to run: from here on now() is not idle, so that nobody takes store and report
  /// for free, and abort() counts.
  void begin();
  /// @param[out] report()  complete. An abort or a failure at any step leaves the record in force as it was.
  void run(Kind kind);

  /// Ends the press at its next step; what is in force stays. Has no effect once the store is being written.
  void abort() { abort_.store(true, std::memory_order_relaxed); }
  Moment now() const;

  const Report& report() const { return report_; }
  /// Of the last press that got as far as images; its spans live in the step arena until the next press.
  const calib::Outcome& outcome() const { return outcome_; }
  bool has_outcome() const { return has_outcome_; }

  bool waiting(grab::GrabStep step, const Reason& why) override;
  bool on_step(const calib::Progress& progress) override;

 private:
  Status grab();
  Status measure();
  Status keep();
  Status check();
  void conclude(Status status);
  void enter(State state, int percent);
  bool go_on();
  void add(const Reason& reason);

  Parts parts_;
  std::atomic<uint16_t> moment_{0};  ///< state and percent together, so that nobody sees one without the other
  std::atomic<bool> abort_{false};
  grab::Grabbed shot_;
  calib::Outcome outcome_;
  std::optional<Arena::Scope> shot_memory_;  ///< what outcome_ points into; given back when the next shot begins
  store::Record record_;
  Report report_;
  bool has_outcome_ = false;
};

}  // namespace roomcal::press
