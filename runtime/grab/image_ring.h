#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/fixed_vector.h"
#include "runtime/base/span2d.h"
#include "runtime/base/status.h"
#include "runtime/ports/image_source.h"

namespace roomcal::grab {

inline constexpr std::size_t kMaxSlots = 4;

/// When an image was exposed, on the host's monotonic clock.
struct ImageTime {
  int64_t exposed_ns = 0;
  int64_t uncertainty_ns = 0;
};

/// An image that its reader holds: nobody writes into it until it is released.
struct HeldImage {
  std::size_t slot = 0;
  ImageView luma;
  ports::ImageFacts facts;
  ImageTime time;
};

/// The last images of one camera, between the thread that takes them and the one that looks at them. Neither waits: the
/// writer overwrites the oldest image that nobody holds.
///
/// One writer, one reader. With n slots the reader may hold n - 1 images.
class ImageRing {
 public:
  ImageRing() = default;
  ImageRing(const ImageRing&) = delete;
  ImageRing& operator=(const ImageRing&) = delete;

  static std::size_t bytes(int width_px, int height_px, std::size_t slots);
  /// @param slots  2 to kMaxSlots. @return kInvalidArgument, kOutOfMemory.
  Status create(int width_px, int height_px, std::size_t slots, Arena& arena);

  /// Writer: a place for the next image; empty where the reader holds all others. Ends with publish() or abandon().
  MutableImageView begin_write();
  void publish(const ports::ImageFacts& facts, const ImageTime& time);
  void abandon();

  /// Reader: holds the images that were exposed at or after a time, newest first, as many as it may hold.
  FixedVector<HeldImage, kMaxSlots> hold_since(int64_t exposed_ns);
  void release(const HeldImage& image);

 private:
  enum class State : uint8_t { kEmpty, kWriting, kReady, kHeld };
  struct Slot {
    std::atomic<State> state{State::kEmpty};
    std::atomic<uint64_t> number{0};  ///< counts images; tells the oldest
    std::atomic<int64_t> exposed_ns{0};
    MutableImageView pixels;
    ports::ImageFacts facts;
    int64_t uncertainty_ns = 0;
  };
  bool take(Slot& slot, State from, State to);
  std::size_t newest_ready(int64_t exposed_ns) const;

  std::array<Slot, kMaxSlots> slots_;
  std::size_t slot_count_ = 0;
  std::size_t writing_ = kMaxSlots;
  std::size_t held_ = 0;
  uint64_t next_number_ = 1;
};

}  // namespace roomcal::grab
