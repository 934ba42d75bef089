#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "runtime/base/span2d.h"
#include "runtime/base/status.h"

namespace roomcal::drivers {

/// Luminance of the JPEG images of a camera, by libjpeg-turbo where the build has it (ROOMCAL_MJPEG, off in lean
/// builds).
///
/// The library takes memory for every image. It asks for it through a table of functions, which we replace: after
/// open() every request is served from the block that was handed in, and there is no heap call any more (a test holds
/// that). Only what a camera sends can be read: sequential JPEG, with or without Huffman tables of its own. Progressive
/// JPEG needs memory for all of its coefficients and is refused.
class MjpegDecoder {
 public:
  /// Whether this build can decode at all.
  static const bool kBuiltIn;

  MjpegDecoder();
  ~MjpegDecoder();
  MjpegDecoder(const MjpegDecoder&) = delete;
  MjpegDecoder& operator=(const MjpegDecoder&) = delete;

  /// What open() wants for images of this width.
  static std::size_t memory_bytes(int width_px);

  /// Before arming: the library takes a little heap here, for good.
  /// @param memory  outlives this.
  /// @return kUnsupported in a build without; kOutOfMemory if that is too little to begin with.
  Status open(std::span<std::byte> memory);

  /// @param jpeg  as the camera sent it; what follows its end does not matter.
  /// @param out  as large as the image; holds anything unless kOk.
  /// @return kOk; kCorrupt for an image that is damaged or ends early, however little of it; kInvalidArgument if it is
  /// of
  ///         another size; kUnsupported if it is no sequential JPEG; kOutOfMemory; kUnavailable before open().
  /// No heap. Cost: about 2.5 ms a megapixel on a desktop's core.
  Status decode(std::span<const std::byte> jpeg, MutableImageView out);

 private:
  struct Library;  // libjpeg's state
  std::unique_ptr<Library> library_;
};

}  // namespace roomcal::drivers
