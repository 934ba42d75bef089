#pragma once

#include <cstdint>

namespace roomcal::console {

enum class Rights : uint8_t {
  kObserve,  ///< look, change nothing; what everybody has
  kOperate,  ///< use the sensors, calibrate
  kService,  ///< undo, restore, reboot
};
/// "observe", "operate", "service".
const char* to_string(Rights rights);

/// Rights that fall back to observe by themselves. They are raised by physical presence only: the board grants them
/// when somebody holds the button.
class RightsGate {
 public:
  explicit RightsGate(int64_t hold_ns) : hold_ns_(hold_ns) {}

  /// Raises (never lowers) the rights and starts their time anew.
  void grant(Rights rights, int64_t now_ns);
  void revoke() { rights_ = Rights::kObserve; }
  /// @return true if the rights fell back in this call.
  bool lapse(int64_t now_ns);
  Rights rights() const { return rights_; }

 private:
  int64_t hold_ns_;
  int64_t until_ns_ = 0;
  Rights rights_ = Rights::kObserve;
};

}  // namespace roomcal::console
