#pragma once

#include <cstdint>

#include "runtime/base/arena.h"
#include "runtime/calib/device.h"
#include "runtime/calib/limits.h"
#include "runtime/grab/grabber.h"
#include "runtime/ports/system_clocks.h"

namespace roomcal::press {

/// What one look at a sensor showed: is the picture good, are rings seen, does the sweep cover the room?
struct Sight {
  SensorName sensor;
  bool came = false;  ///< an image or a sweep
  Reason complaint;   ///< what is wrong with it, with the remedy; empty if nothing is
  // Of a camera.
  bool camera = true;
  int low = 0, mean = 0, high = 0;  ///< grey levels: darkest and brightest hundredth
  double saturated = 0;             ///< share of pixels at 255
  std::size_t rings = 0, usable_rings = 0;
  double detect_ms = 0;
  // Of a LiDAR.
  std::size_t points = 0;
  double horizon = 0;  ///< share of its horizon with returns
  double nearest_m = 0, farthest_m = 0;
  uint32_t flags = 0;
};

/// Looks at one sensor, for the console's `grab`. The session's thread only, while nothing else runs.
class Look {
 public:
  /// All outlive it. @param arenas  a session's: step is given back afterwards.
  Look(const calib::Device& device, const calib::Limits& limits, const grab::Sources& sources, Arenas& arenas,
       const ports::SystemClocks& clocks)
      : device_(device), limits_(limits), sources_(sources), arenas_(arenas), clocks_(clocks) {}

  /// @param sensor  number of the device's cameras, then its LiDARs.
  void run(std::size_t sensor);
  const Sight& sight() const { return sight_; }

 private:
  void look_at_camera(std::size_t camera);
  void look_at_lidar(std::size_t lidar);

  const calib::Device& device_;
  const calib::Limits& limits_;
  const grab::Sources& sources_;
  Arenas& arenas_;
  const ports::SystemClocks& clocks_;
  Sight sight_;
};

}  // namespace roomcal::press
