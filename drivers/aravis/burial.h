#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <utility>

#include <arv.h>

#include "drivers/aravis/glib_handle.h"
#include "drivers/os/locked_memory.h"
#include "drivers/relay/library_camera.h"

namespace roomcal::drivers {

/// What the library's threads use of a connection: outlives both them and whoever made it.
class AravisShared {
 public:
  explicit AravisShared(std::shared_ptr<LockedMemory> buffers) : buffers_(std::move(buffers)) {}

  void wake();
  void listen(LibraryCamera::Wake* listener);  ///< null: nobody any more
  void lose_control();
  void stream_runs(bool runs) { stream_runs_ = runs; }
  /// Whether the library may write into the buffers.
  bool stream_runs() const { return stream_runs_; }
  bool control_lost() const { return control_lost_; }
  std::span<std::byte> buffers() const { return buffers_->bytes(); }

 private:
  std::shared_ptr<LockedMemory> buffers_;
  std::atomic<bool> control_lost_{false}, stream_runs_{false};
  std::mutex mutex_;
  LibraryCamera::Wake* listener_ = nullptr;
};

/// A connection to a camera. The stream goes first: it uses the camera's device, and both what is shared.
struct AravisConnection {
  std::shared_ptr<AravisShared> shared;
  GObjectPtr<ArvCamera> camera;
  GObjectPtr<ArvStream> stream;
};

/// Gives up a connection to a camera that does not answer, in a thread of its own: Aravis 0.8 sends its farewells five
/// times with half a second of patience each, 7.5 s in all, and its 0.8.26 may wait for a USB transfer for ever.
/// A new connection to the same camera may be opened meanwhile: what the old one says to a camera that another port
/// controls is refused by it.
class Burial {
 public:
  /// @return whether all is done, at the latest after `wait_ns`.
  bool wait(int64_t wait_ns) const;

  void bury(AravisConnection connection);

 private:
  std::shared_ptr<std::atomic<int>> connections_ = std::make_shared<std::atomic<int>>(0);
};

}  // namespace roomcal::drivers
