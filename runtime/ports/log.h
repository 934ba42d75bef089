#pragma once

#include <string_view>

namespace roomcal::ports {

/// Where one-line messages go: the device's ring, read back with `log`. Callable from every thread; does not wait long.
class Log {
 public:
  virtual ~Log() = default;
  /// @param who  the part that speaks: "cam2", "store". @param what  one line without a newline; cut if too long.
  virtual void note(std::string_view who, std::string_view what) = 0;
};

}  // namespace roomcal::ports
