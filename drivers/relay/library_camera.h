#pragma once

#include <cstddef>
#include <cstdint>

#include "drivers/image/luma.h"
#include "drivers/image/start_status.h"
#include "runtime/base/status.h"
#include "runtime/base/time.h"
#include "runtime/ports/image_source.h"

namespace roomcal::drivers {

inline constexpr int kMaxLibraryBuffers = 16;

/// One finished buffer of a library.
struct LibraryImage {
  int slot = -1;                                        ///< which of its buffers; goes back by give_back()
  ports::ImageFault fault = ports::ImageFault::kCount;  ///< kCount: whole; otherwise only `slot` means anything
  RawImage raw;                                         ///< lives until give_back()
  uint32_t number = 0;                                  ///< counts up by one per image that the camera made, any start
  Stamp exposed;
  int64_t uncertainty_ns = 0;
  int64_t arrived_ns = 0;            ///< monotonic
  int64_t latency_ns = 100'000'000;  ///< at most from the start of the exposure to the arrival; dates doubtful stamps
};

/// How a step of a library went.
struct LibraryResult {
  ports::ImageFault fault = ports::ImageFault::kCount;  ///< kCount: it went well
  Status status;                                        ///< of `fault`, for start(): the thing and the remedy

  LibraryResult() = default;
  explicit LibraryResult(ports::ImageFault what) : fault(what), status(start_status(what)) {}
  LibraryResult(ports::ImageFault what, StatusCode code, const char* detail) : fault(what), status(code, detail) {}
  bool ok() const { return fault == ports::ImageFault::kCount; }
};

/// A camera behind a library that allocates, starts threads and may take its time: Aravis, libcamera. Every call comes
/// from the one thread that RelaySource gives it, so it may do all of that.
class LibraryCamera {
 public:
  /// Tells the relay that poll() has something. Callable from the library's threads.
  class Wake {
   public:
    virtual ~Wake() = default;
    virtual void wake() = 0;
  };

  virtual ~LibraryCamera() = default;

  /// What it is called in messages: "Aravis".
  virtual const char* library() const = 0;
  /// Checks the options and takes memory for the buffers, once, before the first open().
  /// @return kOutOfMemory; kUnsupported for options that cannot work.
  virtual Status reserve() = 0;
  /// Finds the camera by its key, opens, configures, starts to stream into all buffers.
  virtual LibraryResult open(Wake& wake) = 0;
  /// Stops the stream and starts it.
  virtual LibraryResult restart() = 0;
  /// Gives all back; nothing of the library touches the buffers afterwards, or the next open() fails until that holds.
  virtual void close() = 0;

  /// @return false if no buffer is finished.
  virtual bool poll(LibraryImage& image) = 0;
  virtual void give_back(int slot) = 0;

  /// No image came for too long: what it really is (kStall, kGone, kStale, ...).
  virtual ports::ImageFault diagnose() = 0;
  /// Called about once a second while it streams. @return kCount, or what is wrong.
  virtual ports::ImageFault look_after(int64_t now_ns) = 0;

  /// Whether images come by themselves; otherwise waiting for one is no stall.
  virtual bool free_running() const = 0;
  /// Makes it expose, where it listens to software. @return false if it does not, or could not be told.
  virtual bool fire() = 0;
};

}  // namespace roomcal::drivers
