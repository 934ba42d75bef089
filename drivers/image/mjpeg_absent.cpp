// What a build without libjpeg-turbo has instead of mjpeg.cpp.

#include "drivers/image/mjpeg.h"

namespace roomcal::drivers {

struct MjpegDecoder::Library {};

const bool MjpegDecoder::kBuiltIn = false;

MjpegDecoder::MjpegDecoder() = default;
MjpegDecoder::~MjpegDecoder() = default;

std::size_t MjpegDecoder::memory_bytes(int /*width_px*/) { return 0; }

Status MjpegDecoder::open(std::span<std::byte> /*memory*/) {
  return {StatusCode::kUnsupported, "this build has no JPEG decoder; choose an uncompressed format"};
}

Status MjpegDecoder::decode(std::span<const std::byte> /*jpeg*/, MutableImageView /*out*/) {
  return {StatusCode::kUnavailable, "this build has no JPEG decoder"};
}

}  // namespace roomcal::drivers
