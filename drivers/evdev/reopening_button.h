#pragma once

#include <cstdint>

#include "drivers/evdev/edge_filter.h"
#include "drivers/os/retry.h"
#include "runtime/base/status.h"
#include "runtime/ports/button.h"
#include "runtime/ports/system_clocks.h"

namespace roomcal::drivers {

/// What all buttons on device files share: the promises of ports::Button, and a device that vanishes is looked for
/// again, once a second. A device that was there before then shows its present state; one that is new may be held
/// already.
class ReopeningButton : public ports::Button {
 public:
  /// @return as open(); next() goes on trying.
  Status start();
  bool next(ports::ButtonEdge& edge) final;
  void stop();

  /// To wait on; -1 while the device is not there, or stopped.
  virtual int fd() const = 0;

 protected:
  struct Reading {
    bool tells = false;  ///< false: something else than our button's state
    bool down = false;
    int64_t stamp_ns = 0;
  };

  explicit ReopeningButton(const ports::SystemClocks& clocks) : clocks_(clocks) {}

  /// @param[out] held  whether the button is down now.
  virtual Status open(bool& held) = 0;
  virtual void close() = 0;
  /// The next event; closes a device that has gone. @return false if there is none.
  virtual bool read(Reading& reading) = 0;

  int64_t now_ns() const { return clocks_.now_ns(); }

 private:
  bool come_back(ports::ButtonEdge& edge);

  const ports::SystemClocks& clocks_;
  Retry retry_;
  EdgeFilter filter_;
  bool wanted_ = false;   ///< between start() and stop()
  bool started_ = false;  ///< was there once since start()
};

}  // namespace roomcal::drivers
