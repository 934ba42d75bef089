#include "drivers/v4l2/buffer_ring.h"

#include <algorithm>
#include <cerrno>

#include "drivers/os/time_ns.h"
#include "drivers/v4l2/caps.h"

namespace roomcal::drivers {

using ports::ImageFault;

namespace {

Stamp stamp_of(const v4l2_buffer& buffer) {
  const bool monotonic = (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  const int64_t ns = to_ns(int64_t{buffer.timestamp.tv_sec}, int64_t{buffer.timestamp.tv_usec} * 1000);
  return {ns, monotonic ? ClockId::kMonotonic : ClockId::kUnknown};
}

}  // namespace

BufferRing::Request::Request(const BufferRing& ring, uint32_t index) : buffer(zeroed<v4l2_buffer>()) {
  buffer.type = buffer_type(ring.multiplanar_);
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  if (!ring.multiplanar_) return;
  planes.fill(zeroed<v4l2_plane>());
  buffer.m.planes = planes.data();
  buffer.length = VIDEO_MAX_PLANES;
}

Trouble BufferRing::reserve(bool multiplanar, int count, std::size_t needed_bytes) {
  unmap();
  multiplanar_ = multiplanar;
  auto request = zeroed<v4l2_requestbuffers>();
  request.type = buffer_type(multiplanar);
  request.memory = V4L2_MEMORY_MMAP;
  request.count = static_cast<uint32_t>(count);
  ROOMCAL_TRY_CALL(handle_.call(V4l2Call::kRequestBuffers, VIDIOC_REQBUFS, request));
  constexpr uint32_t kFewest = 2;  // one is being filled while we copy the other
  if (request.count < kFewest) return {ImageFault::kNoMemory, 0};
  for (uint32_t i = 0; i < std::min<uint32_t>(request.count, kMost); ++i) {
    if (const Trouble trouble = map_one(i, needed_bytes); !trouble.none()) {
      unmap();
      return trouble;
    }
  }
  return {};
}

Trouble BufferRing::map_one(uint32_t index, std::size_t needed_bytes) {
  Request request(*this, index);
  ROOMCAL_TRY_CALL(handle_.call(V4l2Call::kRequestBuffers, VIDIOC_QUERYBUF, request.buffer));
  const std::size_t size = multiplanar_ ? request.planes[0].length : request.buffer.length;
  const uint32_t offset = multiplanar_ ? request.planes[0].m.mem_offset : request.buffer.m.offset;
  if (size < needed_bytes) return {ImageFault::kFormat, 0};
  ROOMCAL_TRY_CALL(handle_.map(size, offset, maps_[index]));
  count_ = index + 1;
  return {};
}

void BufferRing::release() {
  unmap();
  auto request = zeroed<v4l2_requestbuffers>();
  request.type = buffer_type(multiplanar_);
  request.memory = V4L2_MEMORY_MMAP;
  static_cast<void>(handle_.call(V4l2Call::kRequestBuffers, VIDIOC_REQBUFS, request));
}

void BufferRing::unmap() {
  for (uint32_t i = 0; i < count_; ++i) handle_.unmap(maps_[i]);
  count_ = 0;
  take_back();
}

Trouble BufferRing::queue_all() {
  for (uint32_t i = 0; i < count_; ++i)
    if (!queued_[i]) ROOMCAL_TRY_CALL(queue(i));
  return {};
}

Trouble BufferRing::queue(uint32_t index) {
  Request request(*this, index);
  ROOMCAL_TRY_CALL(handle_.call(V4l2Call::kQueue, VIDIOC_QBUF, request.buffer));
  queued_[index] = true;
  return {};
}

Trouble BufferRing::dequeue(bool& any, FilledBuffer& filled) {
  any = false;
  Request request(*this);
  const v4l2_buffer& buffer = request.buffer;
  const Trouble trouble = handle_.call(V4l2Call::kDequeue, VIDIOC_DQBUF, request.buffer);
  if (!trouble.none() || trouble.error_number == EAGAIN) return trouble;
  if (buffer.index >= count_ || !queued_[buffer.index]) return {ImageFault::kUnknownBuffer, 0};
  queued_[buffer.index] = false;
  any = true;
  filled.index = buffer.index;
  filled.bytes = filled_part(request);
  filled.sequence = buffer.sequence;
  filled.stamp = stamp_of(buffer);
  filled.at_start_of_exposure = (buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  filled.damaged = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0;
  return {};
}

// A driver that claims more than a buffer holds is believed up to the buffer's end.
std::span<const std::byte> BufferRing::filled_part(const Request& request) const {
  const std::span<const std::byte> map = maps_[request.buffer.index];
  const std::size_t begin = multiplanar_ ? request.planes[0].data_offset : 0;
  const std::size_t end = multiplanar_ ? request.planes[0].bytesused : request.buffer.bytesused;
  const std::size_t last = std::min(end, map.size());
  return begin < last ? map.subspan(begin, last - begin) : std::span<const std::byte>();
}

}  // namespace roomcal::drivers
