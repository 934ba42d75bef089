#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/fixed_text.h"
#include "runtime/base/fixed_vector.h"
#include "runtime/base/status.h"
#include "runtime/grab/image_ring.h"
#include "runtime/grab/scene_patches.h"
#include "runtime/grab/sweep_source.h"
#include "runtime/ports/stillness_sensor.h"
#include "runtime/ports/system_clocks.h"
#include "runtime/ports/trigger.h"

namespace roomcal::grab {

inline constexpr std::size_t kMaxCameraFeeds = 8;
inline constexpr std::size_t kMaxLidarFeeds = 4;
inline constexpr std::size_t kMaxStillnessSensors = 4;

struct CameraFeed {
  SensorName name;
  ImageRing* ring = nullptr;
};
struct LidarFeed {
  SensorName name;
  SweepSource* tray = nullptr;
  std::size_t sweeps = 1;  ///< of one shot
};

/// Where images, sweeps and the knowledge of motion come from. Everything outlives the grabber.
struct Sources {
  FixedVector<CameraFeed, kMaxCameraFeeds> cameras;
  FixedVector<LidarFeed, kMaxLidarFeeds> lidars;
  FixedVector<ports::StillnessSensor*, kMaxStillnessSensors> stillness;
  ports::Trigger* trigger = nullptr;  ///< null: cameras run free
};

struct GrabOptions {
  int64_t patience_ns = 10'000'000'000;   ///< for the device to stand still and a shot to succeed
  int64_t image_wait_ns = 1'500'000'000;  ///< for images that were asked for; raise it for slow still cameras
  int64_t sweep_wait_ns = 2'000'000'000;  ///< for a whole sweep that was asked for
  int64_t dwell_ns = 250'000'000;         ///< at least so long between the images that are compared
  int64_t still_for_ns = 200'000'000;     ///< the sensors of motion must agree for so long before
  /// Exposures of one shot may lie that far apart, beyond their uncertainty. 0: any, for the device is proved to stand
  /// still; a limit makes a lost trigger show.
  int64_t max_spread_ns = 0;
  MotionLimits motion;
};

/// One synchronized grab. Views live until it is released.
struct Grabbed {
  std::array<HeldImage, kMaxCameraFeeds> held;                        ///< luma empty where none came
  FixedVector<ImageView, kMaxCameraFeeds> images;                     ///< one a camera, empty where none came
  FixedVector<std::span<const lidar::Sweep>, kMaxLidarFeeds> sweeps;  ///< one set a LiDAR, empty where none came
  std::array<SceneMotion, kMaxCameraFeeds> motion;  ///< between the images before the sweeps and these
  int64_t begin_ns = 0, end_ns = 0;                 ///< monotonic: the device stood still in between
  int64_t spread_ns = 0;                            ///< between the first and the last exposure
  int64_t uncertainty_ns = 0;                       ///< of the least certain stamp
  std::size_t tries = 0;
  FixedVector<Reason, 8> notes;  ///< what was not as it should be, one line each
};

enum class GrabStep : uint8_t { kStillness, kImages, kSweeps };

/// Told while grab() waits.
class GrabWatcher {
 public:
  virtual ~GrabWatcher() = default;
  /// @param why  what it is waiting for. @return false: give up at once.
  virtual bool waiting(GrabStep step, const Reason& why) = 0;
};

/// Takes shots of a device that stands still, and proves that it did.
///
///     still? -> images -> sweeps -> images -> the same as before? -> shot
///
/// A calibration may wait, so stillness is the rule and stamps only order the data: sensors of motion must agree all
/// the while, and the images before and after the sweeps must show the same. Any doubt means moving; it is then tried
/// again until patience ends. One thread.
class Grabber {
 public:
  Grabber(const Sources& sources, const GrabOptions& options, const ports::SystemClocks& clocks)
      : sources_(sources), options_(options), clocks_(clocks) {}

  /// @param[out] shot  for kOk: release() it when it is no longer looked at. A camera or LiDAR that did not deliver is
  ///         empty in it and has a note.
  /// @return kOk; kUnavailable: never still, or no camera delivered; kNotFound: the trigger cannot be fired;
  /// kCancelled:
  ///         the watcher gave up. `reason()` is the one line for the operator; nothing is held then.
  Status grab(GrabWatcher& watcher, Grabbed& shot);
  void release(Grabbed& shot);

  /// Why the last grab() failed; empty after kOk.
  const Reason& reason() const { return reason_; }

 private:
  Status attempt(GrabWatcher& watcher, Grabbed& shot, bool& moved);
  Status wait_still(GrabWatcher& watcher, int64_t deadline_ns);
  Status take_images(GrabWatcher& watcher, Grabbed& shot);
  Status wait_sweeps(GrabWatcher& watcher, Grabbed& shot);
  void ask_sweeps();
  bool stop_sweeps();
  ports::Stillness look() const;
  bool moved_between(Grabbed& shot);
  void measure_spread(Grabbed& shot);
  Status fail(StatusCode code, const Reason& reason);
  void note(Grabbed& shot, const Reason& reason);

  const Sources& sources_;
  GrabOptions options_;
  const ports::SystemClocks& clocks_;
  std::array<ScenePatches, kMaxCameraFeeds> before_;
  Reason reason_;
};

}  // namespace roomcal::grab
