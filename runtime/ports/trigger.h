#pragma once

#include "runtime/base/status.h"

namespace roomcal::ports {

/// Makes all cameras that listen to it expose at once: a line, a datagram, a CAN message, a command to each of them.
class Trigger {
 public:
  virtual ~Trigger() = default;
  /// "line", "action command", "CAN", "software": for messages and for the record of a shot.
  virtual const char* name() const = 0;
  /// One exposure. @return kUnavailable with the reason if it could not be sent; nothing was exposed then.
  virtual Status fire() = 0;
};

}  // namespace roomcal::ports
