#pragma once

#include <cstdint>
#include <mutex>

#include <libcamera/request.h>

#include "drivers/relay/library_camera.h"
#include "runtime/base/fixed_vector.h"
#include "runtime/ports/clock.h"

namespace roomcal::drivers {

struct Completion {
  libcamera::Request* request = nullptr;
  int64_t arrived_ns = 0;  ///< monotonic
};

/// Requests that have come back, on their way from libcamera's thread to the one that calls it.
class Completions {
 public:
  explicit Completions(const ports::Clock& clock) : clock_(clock) {}

  /// Nothing of before is left.
  void begin(LibraryCamera::Wake& wake);
  /// Nobody is told any more.
  void end();
  bool take(Completion& completion);
  void clear();
  bool disconnected() const;

  // In libcamera's threads.
  void request_completed(libcamera::Request* request);
  void camera_disconnected();

 private:
  const ports::Clock& clock_;
  mutable std::mutex mutex_;
  LibraryCamera::Wake* wake_ = nullptr;
  FixedVector<Completion, kMaxLibraryBuffers> waiting_;  // oldest first
  bool disconnected_ = false;
};

}  // namespace roomcal::drivers
