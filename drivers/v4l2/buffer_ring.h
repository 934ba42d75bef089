#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <linux/videodev2.h>

#include "drivers/v4l2/handle.h"
#include "runtime/base/time.h"

namespace roomcal::drivers {

/// An image that the driver handed over; put back by its index.
struct FilledBuffer {
  uint32_t index = 0;
  std::span<const std::byte> bytes;  ///< of the first plane, as many as the driver says it has filled
  uint32_t sequence = 0;
  Stamp stamp;                        ///< kMonotonic if the driver says so, else kUnknown
  bool at_start_of_exposure = false;  ///< the stamp; else when the image was complete
  bool damaged = false;
};

/// The kernel's buffers of one camera, mapped for reading, and who has each of them.
class BufferRing {
 public:
  static constexpr int kMost = 8;

  explicit BufferRing(const V4l2Handle& handle) : handle_(handle) {}
  ~BufferRing() { unmap(); }
  BufferRing(const BufferRing&) = delete;
  BufferRing& operator=(const BufferRing&) = delete;

  /// Allocates and maps. @param count  wanted; the driver may have it otherwise, up to kMost.
  /// @param needed_bytes  of the first plane; smaller buffers are kFormat.
  /// On trouble nothing stays mapped; release() still gives back what the kernel has allocated.
  Trouble reserve(bool multiplanar, int count, std::size_t needed_bytes);
  /// Unmaps, and tells the kernel to free; whatever that says.
  void release();
  /// The same without the kernel: for a camera that is gone.
  void unmap();

  /// Puts every buffer that we have into the queue.
  Trouble queue_all();
  Trouble queue(uint32_t index);
  /// @param[out] any  whether there was an image; then `filled`.
  /// @return kUnknownBuffer for a buffer that the driver does not have, or had already given back.
  Trouble dequeue(bool& any, FilledBuffer& filled);
  /// The stream was stopped: all buffers are ours again.
  void take_back() { queued_ = {}; }

 private:
  // A buffer for a call; of the multi-planar kind with room for its planes.
  struct Request {
    explicit Request(const BufferRing& ring, uint32_t index = 0);
    v4l2_buffer buffer;
    std::array<v4l2_plane, VIDEO_MAX_PLANES> planes;
  };
  Trouble map_one(uint32_t index, std::size_t needed_bytes);
  std::span<const std::byte> filled_part(const Request& request) const;

  const V4l2Handle& handle_;
  std::array<std::span<const std::byte>, kMost> maps_{};
  std::array<bool, kMost> queued_{};
  uint32_t count_ = 0;
  bool multiplanar_ = false;
};

}  // namespace roomcal::drivers
