#pragma once

#include <cstddef>
#include <string_view>

#include "runtime/base/status.h"
#include "runtime/calib/outcome.h"

namespace roomcal::calib {

/// Where a running session stands: `done` of `total` steps lie behind it, and the one told here comes next. A step is
/// one sensor in a stage, or all of them together; steps of different stages take different times.
struct Progress {
  Stage stage = Stage::kDetect;
  std::string_view sensor;  ///< that the step works on; empty: all together
  std::size_t done = 0;     ///< grows by one with every call of a session, from 0
  std::size_t total = 0;    ///< the same throughout a session
};

/// Watches a session from the thread that computes it: a bar on a display, a button that stops it.
class Observer {
 public:
  virtual ~Observer() = default;
  /// Called before every step, also of a sensor that turns out to need none.
  /// @return false: stop here. Nothing of the session may be stored then.
  virtual bool on_step(const Progress& progress) = 0;
};

/// Counts a session's steps and tells them to its observer, if it has one.
class Steps {
 public:
  Steps(Observer* observer, std::size_t total) : observer_(observer) { progress_.total = total; }

  /// Before every step. @return kOk, or kCancelled if the observer wants no more.
  Status begin(Stage stage, std::string_view sensor = {});
  /// Of the step that was begun last.
  const Progress& progress() const { return progress_; }

 private:
  Observer* observer_;
  Progress progress_;
  bool begun_ = false;
};

}  // namespace roomcal::calib
