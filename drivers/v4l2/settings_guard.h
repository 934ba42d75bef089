#pragma once

#include <array>
#include <cstdint>

#include <linux/videodev2.h>

#include "drivers/v4l2/format.h"
#include "drivers/v4l2/handle.h"

namespace roomcal::drivers {

/// What a camera was set to before we came, and puts it back.
class SettingsGuard {
 public:
  explicit SettingsGuard(const V4l2Handle& handle) : handle_(handle) {}

  /// Before the first change. Of a camera that does not tell, nothing is put back.
  void remember(bool multiplanar);
  /// Sets a control after noting what it was. @param[in,out] value  as the camera took it.
  Trouble set_control(uint32_t id, int32_t& value);
  /// Sets how many images a second. @param fps  0: only asks.
  /// @param[out] period_ns  the time between images, as the camera took it; untouched if it does not say.
  Trouble set_rate(bool multiplanar, double fps, int64_t& period_ns);

  /// Puts everything back, in reverse order, as far as the camera still listens. Not while buffers are allocated.
  void restore();
  /// Nothing to put back: the camera is gone.
  void forget();

 private:
  struct Control {
    uint32_t id;
    int32_t value;
  };

  const V4l2Handle& handle_;
  std::array<Control, 8> controls_{};
  std::size_t control_count_ = 0;
  FormatCall format_{false};
  v4l2_streamparm rate_ = zeroed<v4l2_streamparm>();
  bool has_format_ = false;
  bool has_rate_ = false;
};

}  // namespace roomcal::drivers
