// How the fake cameras' drivers answer: after the kernel's pages of each ioctl and videobuf2's habits.

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "tests/drivers/v4l2/fake_kernel.h"

namespace roomcal::drivers::test {

namespace {

template <std::size_t kSize>
void write_text(unsigned char (&field)[kSize], const char* text) {
  std::memset(field, 0, kSize);
  std::memcpy(field, text, std::min(std::strlen(text), kSize - 1));
}

template <typename T>
T& as(void* argument) {
  return *static_cast<T*>(argument);
}

}  // namespace

int FakeKernel::answer(Driver& driver, int fd, unsigned long request, void* argument) {
  switch (request) {
    case VIDIOC_QUERYCAP:
      return query_cap(driver, as<v4l2_capability>(argument));
    case VIDIOC_G_FMT:
      return get_format(driver, as<v4l2_format>(argument));
    case VIDIOC_S_FMT:
      return set_format(driver, as<v4l2_format>(argument));
    case VIDIOC_G_PARM:
      return rate(driver, as<v4l2_streamparm>(argument), false);
    case VIDIOC_S_PARM:
      return rate(driver, as<v4l2_streamparm>(argument), true);
    case VIDIOC_QUERYCTRL:
      return query_control(driver, as<v4l2_queryctrl>(argument));
    case VIDIOC_G_CTRL:
      return control(driver, as<v4l2_control>(argument), false);
    case VIDIOC_S_CTRL:
      return control(driver, as<v4l2_control>(argument), true);
    case VIDIOC_REQBUFS:
      return request_buffers(driver, fd, as<v4l2_requestbuffers>(argument));
    case VIDIOC_QUERYBUF:
      return query_buffer(driver, as<v4l2_buffer>(argument));
    case VIDIOC_QBUF:
      return queue_buffer(driver, as<v4l2_buffer>(argument));
    case VIDIOC_DQBUF:
      return dequeue_buffer(driver, as<v4l2_buffer>(argument));
    case VIDIOC_SUBSCRIBE_EVENT:
      return 0;
    case VIDIOC_DQEVENT:
      return dequeue_event(driver, as<v4l2_event>(argument));
    case VIDIOC_STREAMON:
      if (driver.owner != fd) return -EINVAL;
      driver.streaming = true;
      driver.sequence = driver.is.first_sequence;
      driver.next_ns = clocks_.now_ns() + driver.is.period_ns;
      return 0;
    case VIDIOC_STREAMOFF:
      driver.streaming = driver.broken = false;
      driver.queue.clear();
      driver.done.clear();
      return 0;
    default:
      return -ENOTTY;
  }
}

int FakeKernel::query_cap(const Driver& driver, v4l2_capability& caps) const {
  write_text(caps.card, driver.is.card);
  write_text(caps.bus_info, driver.is.bus_info);
  // As uvcvideo does: the device as a whole captures, whatever this node does.
  caps.capabilities = driver.is.capabilities | V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_DEVICE_CAPS;
  caps.device_caps = driver.is.capabilities;
  return 0;
}

int FakeKernel::get_format(const Driver& driver, v4l2_format& format) const {
  const FakeCamera& is = driver.is;
  const uint32_t fourcc = driver.fourcc != 0 ? driver.fourcc : is.fourccs[0];
  const auto size = static_cast<uint32_t>(is.jpeg.empty() ? is.stride * is.height : FakeCamera::kBytes);
  const auto fill = [&](auto& pixels) {
    pixels.width = static_cast<uint32_t>(is.width);
    pixels.height = static_cast<uint32_t>(is.height);
    pixels.pixelformat = fourcc;
    pixels.field = V4L2_FIELD_NONE;
  };
  if (multiplanar(driver)) {
    fill(format.fmt.pix_mp);
    format.fmt.pix_mp.num_planes = 2;
    format.fmt.pix_mp.plane_fmt[0].bytesperline = static_cast<uint32_t>(is.stride);
    format.fmt.pix_mp.plane_fmt[0].sizeimage = size;
  } else {
    fill(format.fmt.pix);
    format.fmt.pix.bytesperline = static_cast<uint32_t>(is.stride);
    format.fmt.pix.sizeimage = size;
  }
  return 0;
}

int FakeKernel::set_format(Driver& driver, v4l2_format& format) {
  const uint32_t type = multiplanar(driver) ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (format.type != type) return -EINVAL;
  if (driver.allocated != 0) return -EBUSY;
  const uint32_t wanted = multiplanar(driver) ? format.fmt.pix_mp.pixelformat : format.fmt.pix.pixelformat;
  const auto& offered = driver.is.fourccs;
  const bool has = std::find(offered.begin(), offered.end(), wanted) != offered.end();
  driver.fourcc = has ? wanted : offered[0];
  return get_format(driver, format);
}

int FakeKernel::rate(Driver& driver, v4l2_streamparm& rate, bool set) {
  if (set && !driver.is.has_rate) return -ENOTTY;
  v4l2_fract& period = rate.parm.capture.timeperframe;
  if (set && period.denominator != 0)
    driver.is.period_ns = period.numerator * int64_t{1'000'000'000} / period.denominator;
  rate.parm.capture.capability = driver.is.has_rate ? V4L2_CAP_TIMEPERFRAME : 0;
  period = {static_cast<uint32_t>(driver.is.period_ns), 1'000'000'000};
  return 0;
}

int FakeKernel::query_control(const Driver& driver, v4l2_queryctrl& query) const {
  const uint32_t after = query.id & ~V4L2_CTRL_FLAG_NEXT_CTRL;
  const FakeCamera::Control* next = nullptr;
  for (const FakeCamera::Control& control : driver.is.controls)
    if (control.id > after && (next == nullptr || control.id < next->id)) next = &control;
  if (next == nullptr) return -EINVAL;
  query.id = next->id;
  write_text(query.name, next->name);
  return 0;
}

int FakeKernel::control(Driver& driver, v4l2_control& control, bool set) {
  for (FakeCamera::Control& own : driver.is.controls) {
    if (own.id != control.id) continue;
    if (set) own.value = std::clamp(control.value, own.low, own.high);
    control.value = own.value;
    return 0;
  }
  return -EINVAL;
}

int FakeKernel::request_buffers(Driver& driver, int fd, v4l2_requestbuffers& request) {
  if (driver.owner >= 0 && driver.owner != fd) return -EBUSY;
  free_buffers(driver);
  driver.allocated = std::min<uint32_t>(request.count, FakeCamera::kBuffers);
  request.count = driver.allocated;
  if (driver.allocated != 0) driver.owner = fd;
  return 0;
}

int FakeKernel::query_buffer(const Driver& driver, v4l2_buffer& buffer) const {
  if (buffer.index >= driver.allocated) return -EINVAL;
  if (multiplanar(driver)) {
    buffer.m.planes[0].length = FakeCamera::kBytes;
    buffer.m.planes[0].m.mem_offset = buffer.index * FakeCamera::kBytes;
  } else {
    buffer.length = FakeCamera::kBytes;
    buffer.m.offset = buffer.index * FakeCamera::kBytes;
  }
  return 0;
}

int FakeKernel::queue_buffer(Driver& driver, const v4l2_buffer& buffer) {
  const auto& queue = driver.queue;
  if (buffer.index >= driver.allocated) return -EINVAL;
  const bool twice = std::find(queue.begin(), queue.end(), buffer.index) != queue.end();
  if (twice || !driver.queue.push_back(buffer.index)) {
    ++misuses_;
    return -EINVAL;
  }
  return 0;
}

int FakeKernel::dequeue_buffer(Driver& driver, v4l2_buffer& buffer) {
  if (driver.broken) return -EIO;
  if (!driver.streaming) return -EINVAL;
  if (driver.done.empty()) return -EAGAIN;
  const Done done = pop_front(driver.done);
  buffer.index = driver.is.returned_index >= 0 ? static_cast<uint32_t>(driver.is.returned_index) : done.index;
  buffer.sequence = done.sequence;
  buffer.flags = done.flags;
  buffer.timestamp.tv_sec = done.stamp_ns / 1'000'000'000;
  buffer.timestamp.tv_usec = done.stamp_ns % 1'000'000'000 / 1000;
  if (multiplanar(driver)) {
    buffer.m.planes[0].bytesused = done.bytes;
    buffer.m.planes[0].data_offset = 0;
  } else {
    buffer.bytesused = done.bytes;
  }
  return 0;
}

int FakeKernel::dequeue_event(Driver& driver, v4l2_event& event) {
  if (driver.events.empty()) return -ENOENT;
  event.type = pop_front(driver.events);
  return 0;
}

}  // namespace roomcal::drivers::test
