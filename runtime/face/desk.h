#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "runtime/base/status.h"
#include "runtime/calib/session.h"
#include "runtime/face/vitals.h"
#include "runtime/marker/detector.h"
#include "runtime/press/press.h"
#include "runtime/profile/profile.h"
#include "runtime/store/store.h"

namespace roomcal::face {

/// What a person who asks at the console can have done. The board does it; nothing here waits.
class Desk {
 public:
  virtual ~Desk() = default;

  /// Starts a press. @return kUnavailable with the reason: one runs already, or the device is not armed.
  virtual Status start(press::Kind kind) = 0;
  /// Ends the running press. @return kNotFound if none runs.
  virtual Status abort() = 0;
  /// Looks at one image or sweep; the answer comes as an event. @return as start(); kNotFound for an unknown sensor.
  virtual Status look(std::string_view sensor) = 0;
  /// Tries a part: "led", "watchdog", ... @return how it went; `detail` is filled for kOk.
  virtual Status selftest(std::string_view part, Reason& detail) = 0;
  /// Starts the device again after the answer has gone out.
  virtual Status reboot() = 0;

  /// Fills the vitals of this moment.
  virtual void examine(Vitals& vitals) = 0;
  /// Lines of the log, oldest first; `visit` gets each. @param lines  how many of the last.
  virtual void read_log(std::size_t lines, void (*visit)(void* context, std::string_view line), void* context) = 0;
  virtual int64_t unix_s() const = 0;
};

/// What the console tells about. Pointers are null on a device that could not be armed so far.
struct Known {
  std::string_view firmware;
  std::string_view board;
  const profile::Profile* profile = nullptr;
  const map::RoomMap* map = nullptr;
  store::Store* store = nullptr;
  press::Press* press = nullptr;
};

}  // namespace roomcal::face
