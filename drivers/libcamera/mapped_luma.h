#pragma once

#include <cstddef>
#include <span>

#include <libcamera/framebuffer.h>

namespace roomcal::drivers {

/// The first plane of one of libcamera's buffers, mapped for reading for as long as this lives: luminance comes first
/// in every format that we read.
class MappedLuma {
 public:
  MappedLuma() = default;
  ~MappedLuma() { unmap(); }
  MappedLuma(const MappedLuma&) = delete;
  MappedLuma& operator=(const MappedLuma&) = delete;

  /// @return false if the kernel does not map it.
  bool map(const libcamera::FrameBuffer& buffer);
  void unmap();
  std::span<const std::byte> bytes() const { return plane_; }

  /// Around every reading of a filled buffer: the processor's cache may know an older one (dma-buf of the kernel).
  void begin_read();
  void end_read();

 private:
  std::span<std::byte> mapping_;
  std::span<const std::byte> plane_;
  int fd_ = -1;  // the buffer's
  bool reading_ = false;
};

}  // namespace roomcal::drivers
