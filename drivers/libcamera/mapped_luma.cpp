#include "drivers/libcamera/mapped_luma.h"

#include <cstdint>
#include <utility>

#include <linux/dma-buf.h>
#include <sys/ioctl.h>
#include <sys/mman.h>

namespace roomcal::drivers {

namespace {

// Memory that is no dma-buf needs no synchronization, and says so; so does a kernel that fails here for a moment.
void synchronize(int fd, uint64_t flags) {
  dma_buf_sync sync{};
  sync.flags = flags | DMA_BUF_SYNC_READ;
  static_cast<void>(::ioctl(fd, DMA_BUF_IOCTL_SYNC, &sync));
}

}  // namespace

bool MappedLuma::map(const libcamera::FrameBuffer& buffer) {
  unmap();
  if (buffer.planes().empty()) return false;
  const libcamera::FrameBuffer::Plane& plane = buffer.planes()[0];
  // All planes may lie in one file: it is mapped from its start, as offsets need not be whole pages.
  const std::size_t offset = plane.offset, size = offset + plane.length;
  void* place = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, plane.fd.get(), 0);
  if (place == MAP_FAILED) return false;
  mapping_ = {static_cast<std::byte*>(place), size};
  plane_ = mapping_.subspan(offset);
  fd_ = plane.fd.get();
  return true;
}

void MappedLuma::unmap() {
  if (!mapping_.empty()) ::munmap(mapping_.data(), mapping_.size());
  mapping_ = {};
  plane_ = {};
  fd_ = -1;
}

void MappedLuma::begin_read() {
  synchronize(fd_, DMA_BUF_SYNC_START);
  reading_ = true;
}

void MappedLuma::end_read() {
  if (std::exchange(reading_, false)) synchronize(fd_, DMA_BUF_SYNC_END);
}

}  // namespace roomcal::drivers
