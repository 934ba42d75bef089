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

struct Row {
  unsigned long request;
  FakeCall call;
};

constexpr auto kRequests = std::to_array<Row>({
    {VIDIOC_QUERYCAP, FakeCall::kQueryCap},
    {VIDIOC_G_FMT, FakeCall::kGetFormat},
    {VIDIOC_S_FMT, FakeCall::kSetFormat},
    {VIDIOC_G_PARM, FakeCall::kGetRate},
    {VIDIOC_S_PARM, FakeCall::kSetRate},
    {VIDIOC_QUERYCTRL, FakeCall::kQueryControl},
    {VIDIOC_G_CTRL, FakeCall::kGetControl},
    {VIDIOC_S_CTRL, FakeCall::kSetControl},
    {VIDIOC_REQBUFS, FakeCall::kRequestBuffers},
    {VIDIOC_QUERYBUF, FakeCall::kQueryBuffer},
    {VIDIOC_QBUF, FakeCall::kQueue},
    {VIDIOC_DQBUF, FakeCall::kDequeue},
    {VIDIOC_STREAMON, FakeCall::kStreamOn},
    {VIDIOC_STREAMOFF, FakeCall::kStreamOff},
    {VIDIOC_SUBSCRIBE_EVENT, FakeCall::kSubscribe},
    {VIDIOC_DQEVENT, FakeCall::kDequeueEvent},
});

FakeCall kind_of(unsigned long request) {
  for (const Row& row : kRequests)
    if (row.request == request) return row.call;
  return FakeCall::kCount;
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
    ++failed_;
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
