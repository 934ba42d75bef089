#pragma once

#include <cstddef>
#include <cstdint>

#include "drivers/image/stamp_check.h"
#include "drivers/v4l2/buffer_ring.h"
#include "drivers/v4l2/settings.h"
#include "runtime/ports/image_source.h"

namespace roomcal::drivers {

/// What became of one image.
struct Judgement {
  ports::ImageFault fault = ports::ImageFault::kCount;  ///< counted, also of images that are kept
  bool keep = false;                                    ///< hand it over, with `facts`
  bool backlog = false;                                 ///< whole, but from a time when nobody asked: superseded
  ports::ImageFacts facts;
};

/// Looks at every image of one stream before it is believed. Pure; time is monotonic.
///
/// | of the image | what follows |
/// |---|---|
/// | marked damaged, or short | fault, dropped |
/// | stamp older than 1 s | fault, dropped; where nobody had asked for 1 s: backlog |
/// | stamp and number of the image before | fault, dropped: it may be the image before |
/// | stamp wrong in another way, or of an unknown clock | fault, kept, stamped by its arrival; if that is not known to
/// 1 s: backlog | | else | kept |
class ImageJudge {
 public:
  /// A stream starts. @param luma_bytes  that an image must have; 0: any.
  void begin(std::size_t luma_bytes, const Timing& timing, int64_t now_ns);
  /// No image was waiting at that time: the next one arrives later.
  void seen_empty(int64_t now_ns) { empty_ns_ = now_ns; }

  Judgement judge(const FilledBuffer& image, int64_t now_ns);
  /// An image was handed over: what was lost before it is told.
  void told() { lost_ = 0, gap_ = false; }

 private:
  void date(const FilledBuffer& image, bool believed, ports::ImageFacts& facts) const;

  StampCheck stamps_;
  SequenceCount numbers_;
  Timing timing_;
  std::size_t luma_bytes_ = 0;
  int64_t empty_ns_ = 0;
  uint32_t lost_ = 0;  // since the image that was handed over last
  bool gap_ = false;
  bool late_ = false;  // so was the image before
};

}  // namespace roomcal::drivers
