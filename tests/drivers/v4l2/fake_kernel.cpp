#include "tests/drivers/v4l2/fake_kernel.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include <poll.h>

namespace roomcal::drivers::test {

namespace {

constexpr int kFirstDescriptor = 100;
constexpr int64_t kCallNs = 1000;

template <std::size_t kSize>
void write_text(unsigned char (&field)[kSize], const char* text) {
  std::memset(field, 0, kSize);
  std::memcpy(field, text, std::min(std::strlen(text), kSize - 1));
}

template <typename T>
T& as(void* argument) {
  return *static_cast<T*>(argument);
}

template <typename T, std::size_t kCapacity>
T pop_front(FixedVector<T, kCapacity>& items) {
  const T first = items[0];
  std::copy(items.begin() + 1, items.end(), items.begin());
  items.pop_back();
  return first;
}

FakeCall kind_of(unsigned long request) {
  switch (request) {
    case VIDIOC_QUERYCAP:
      return FakeCall::kQueryCap;
    case VIDIOC_G_FMT:
      return FakeCall::kGetFormat;
    case VIDIOC_S_FMT:
      return FakeCall::kSetFormat;
    case VIDIOC_G_PARM:
      return FakeCall::kGetRate;
    case VIDIOC_S_PARM:
      return FakeCall::kSetRate;
    case VIDIOC_QUERYCTRL:
      return FakeCall::kQueryControl;
    case VIDIOC_G_CTRL:
      return FakeCall::kGetControl;
    case VIDIOC_S_CTRL:
      return FakeCall::kSetControl;
    case VIDIOC_REQBUFS:
      return FakeCall::kRequestBuffers;
    case VIDIOC_QUERYBUF:
      return FakeCall::kQueryBuffer;
    case VIDIOC_QBUF:
      return FakeCall::kQueue;
    case VIDIOC_DQBUF:
      return FakeCall::kDequeue;
    case VIDIOC_STREAMON:
      return FakeCall::kStreamOn;
    case VIDIOC_STREAMOFF:
      return FakeCall::kStreamOff;
    case VIDIOC_SUBSCRIBE_EVENT:
      return FakeCall::kSubscribe;
    case VIDIOC_DQEVENT:
      return FakeCall::kDequeueEvent;
    default:
      return FakeCall::kCount;
  }
}

}  // namespace

const char* to_string(FakeCall call) {
  constexpr std::array<const char*, 23> kNames = {
      "open",   "QUERYCAP",        "G_FMT",    "S_FMT", "G_PARM",   "S_PARM",   "QUERYCTRL", "G_CTRL",
      "S_CTRL", "REQBUFS",         "QUERYBUF", "mmap",  "QBUF",     "STREAMON", "STREAMOFF", "poll",
      "DQBUF",  "SUBSCRIBE_EVENT", "DQEVENT",  "list",  "describe", "readlink", "reset"};
  return kNames[static_cast<std::size_t>(call)];
}

FakeCamera& FakeKernel::add(const char* node, const char* path, const char* serial) {
  FakeCamera& camera = cameras_[static_cast<std::size_t>(camera_count_++)].is;
  camera.node.name = node;
  camera.node.path = path;
  camera.node.title = "Fake: Fake";
  camera.node.serial = serial;
  static_cast<void>(camera.fourccs.push_back(V4L2_PIX_FMT_GREY));
  camera.plugged = true;
  return camera;
}

void FakeKernel::plug(FakeCamera& camera, const char* node) {
  camera.node.name = node;
  camera.plugged = true;
}

void FakeKernel::unplug(FakeCamera& camera) {
  camera.plugged = false;
  for (Descriptor& descriptor : descriptors_)
    if (descriptor.used && &cameras_[static_cast<std::size_t>(descriptor.camera)].is == &camera)
      descriptor.alive = false;
}

void FakeKernel::break_queue(FakeCamera& camera) {
  for (Driver& driver : cameras_)
    if (&driver.is == &camera) driver.broken = true;
}

void FakeKernel::raise_event(FakeCamera& camera, uint32_t type) {
  for (Driver& driver : cameras_)
    if (&driver.is == &camera) static_cast<void>(driver.events.push_back(type));
}

void FakeKernel::fail(FakeCall call, int error_number, int skip, int times) {
  static_cast<void>(script_.push_back({call, error_number, skip, times}));
}

int FakeKernel::open_descriptors() const {
  return static_cast<int>(
      std::count_if(descriptors_.begin(), descriptors_.end(), [](const Descriptor& d) { return d.used; }));
}

// Counts the call, lets time pass, and tells the errno that the script has for it, or 0.
int FakeKernel::enter(FakeCall call) {
  clocks_.advance_to(clocks_.now_ns() + kCallNs);
  ++counts_[static_cast<std::size_t>(call)];
  if (call == hook_call_) {
    hook_call_ = FakeCall::kCount;
    hook_(*this);
  }
  for (Failure& failure : script_) {
    if (failure.call != call || failure.times == 0) continue;
    if (failure.skip-- > 0) continue;
    --failure.times;
    return failure.error_number;
  }
  return 0;
}

FakeKernel::Driver* FakeKernel::at(int fd) {
  const auto i = static_cast<std::size_t>(fd - kFirstDescriptor);
  if (i < descriptors_.size() && descriptors_[i].used)
    return &cameras_[static_cast<std::size_t>(descriptors_[i].camera)];
  ++misuses_;
  return nullptr;
}

int FakeKernel::open(std::string_view node) {
  if (const int error = enter(FakeCall::kOpen); error != 0) return -error;
  for (int c = 0; c < camera_count_; ++c) {
    const FakeCamera& camera = cameras_[static_cast<std::size_t>(c)].is;
    if (!camera.plugged || camera.node.name.view() != node) continue;
    for (std::size_t i = 0; i < descriptors_.size(); ++i) {
      if (descriptors_[i].used) continue;
      descriptors_[i] = {true, true, c};
      return kFirstDescriptor + static_cast<int>(i);
    }
    return -EMFILE;
  }
  return -ENOENT;
}

void FakeKernel::close(int fd) {
  Driver* driver = at(fd);
  if (driver == nullptr) return;
  if (driver->owner == fd) free_buffers(*driver);
  descriptors_[static_cast<std::size_t>(fd - kFirstDescriptor)] = {};
}

void FakeKernel::free_buffers(Driver& driver) {
  driver.streaming = driver.broken = false;
  driver.queue.clear();
  driver.done.clear();
  driver.allocated = 0;
  driver.owner = -1;
}

int FakeKernel::ioctl(int fd, unsigned long request, void* argument) {
  const int error = enter(kind_of(request));
  Driver* driver = at(fd);
  if (driver == nullptr) return -EBADF;
  if (error != 0) return -error;
  if (!descriptors_[static_cast<std::size_t>(fd - kFirstDescriptor)].alive) return -ENODEV;
  produce(*driver, clocks_.now_ns());
  return answer(*driver, fd, request, argument);
}

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

// Exposes all images up to a time.
void FakeKernel::produce(Driver& driver, int64_t until_ns) {
  if (!driver.streaming || driver.broken) return;
  for (; driver.next_ns <= until_ns; driver.next_ns += driver.is.period_ns)
    if (!driver.is.silent) expose(driver);
}

void FakeKernel::expose(Driver& driver) {
  FakeCamera& is = driver.is;
  const uint32_t sequence = driver.sequence;
  if (!is.frozen_sequence) ++driver.sequence;
  if (is.lose_next > 0) {
    --is.lose_next;
    return;
  }
  if (driver.queue.empty()) return;  // nowhere to put it: its number is gone
  const uint32_t index = pop_front(driver.queue);
  std::array<std::byte, FakeCamera::kBytes>& memory = driver.memory[index];
  memory.fill(std::byte{0xEE});
  std::copy(is.jpeg.begin(), is.jpeg.end(), memory.begin());
  for (int y = 0; y < is.height && is.jpeg.empty(); ++y)
    for (int x = 0; x < is.width; ++x)
      memory[static_cast<std::size_t>(y * is.stride + x * is.luma_step + is.luma_at)] =
          static_cast<std::byte>(sequence + static_cast<uint32_t>(x + 3 * y));
  if (!is.frozen_stamp) driver.last_stamp_ns = driver.next_ns;
  const int whole = is.jpeg.empty() ? is.stride * is.height : static_cast<int>(is.jpeg.size());
  const auto bytes = static_cast<uint32_t>(whole - is.missing_bytes);
  static_cast<void>(driver.done.push_back(
      {index, sequence, is.stamp_flags | is.damage_flags, bytes, driver.last_stamp_ns + is.stamp_offset_ns}));
}

int FakeKernel::map(int fd, std::size_t size, int64_t offset, std::span<const std::byte>& bytes) {
  const int error = enter(FakeCall::kMap);
  Driver* driver = at(fd);
  if (driver == nullptr) return -EBADF;
  if (error != 0) return -error;
  const auto index = static_cast<std::size_t>(offset / FakeCamera::kBytes);
  if (index >= driver->allocated || size > FakeCamera::kBytes) return -EINVAL;
  ++mappings_;
  bytes = std::span<const std::byte>(driver->memory[index]).first(size);
  return 0;
}

void FakeKernel::unmap(std::span<const std::byte> bytes) {
  if (bytes.empty() || --mappings_ < 0) ++misuses_;
}

int FakeKernel::poll(int fd, int64_t timeout_ns) {
  const int error = enter(FakeCall::kPoll);
  Driver* driver = at(fd);
  if (driver == nullptr) return -EBADF;
  if (error != 0) return -error;
  const int64_t until_ns = clocks_.now_ns() + timeout_ns;
  for (;;) {
    if (!descriptors_[static_cast<std::size_t>(fd - kFirstDescriptor)].alive) return POLLERR | POLLHUP;
    produce(*driver, clocks_.now_ns());
    int events = driver->done.empty() ? 0 : POLLIN;
    if (!driver->events.empty()) events |= POLLPRI;
    if (!driver->streaming || driver->broken) events = POLLERR;
    if (events != 0 || clocks_.now_ns() >= until_ns) return events;
    clocks_.advance_to(std::min(until_ns, std::max(driver->next_ns, clocks_.now_ns() + 1)));
  }
}

int FakeKernel::list(std::span<NodeName> names) {
  if (const int error = enter(FakeCall::kList); error != 0) return -error;
  std::size_t count = 0;
  for (const Driver& driver : cameras_)
    if (driver.is.plugged && count < names.size()) names[count++] = driver.is.node.name;
  return static_cast<int>(count);
}

int FakeKernel::describe(std::string_view name, VideoNode& node) {
  if (const int error = enter(FakeCall::kDescribe); error != 0) return -error;
  for (const Driver& driver : cameras_) {
    if (!driver.is.plugged || driver.is.node.name.view() != name) continue;
    node = driver.is.node;
    return 0;
  }
  return -ENOENT;
}

int FakeKernel::read_link(std::string_view /*path*/, FixedText<255>& target) {
  if (const int error = enter(FakeCall::kReadLink); error != 0) return -error;
  if (link_ == nullptr) return -ENOENT;
  target = link_;
  return 0;
}

int FakeKernel::reset_usb_device(std::string_view /*device*/) {
  if (const int error = enter(FakeCall::kReset); error != 0) return -error;
  for (Driver& driver : cameras_) driver.is.silent = false;
  return 0;
}

}  // namespace roomcal::drivers::test
