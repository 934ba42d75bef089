#include "drivers/libcamera/shared_manager.h"

#include <mutex>

namespace roomcal::drivers {

std::shared_ptr<libcamera::CameraManager> shared_manager() {
  static std::mutex mutex;
  static std::weak_ptr<libcamera::CameraManager> known;
  const std::lock_guard lock(mutex);
  if (std::shared_ptr<libcamera::CameraManager> manager = known.lock()) return manager;
  // The last owner stops it under the same lock, so that no second one is made meanwhile.
  const auto stop = [](libcamera::CameraManager* manager) {
    const std::lock_guard stopping(mutex);
    manager->stop();
    delete manager;
  };
  auto fresh = std::make_unique<libcamera::CameraManager>();
  if (fresh->start() != 0) return nullptr;
  std::shared_ptr<libcamera::CameraManager> manager(fresh.release(), stop);
  known = manager;
  return manager;
}

}  // namespace roomcal::drivers
