#include "drivers/v4l2/linux_kernel.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <initializer_list>

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "drivers/os/time_ns.h"
#include "drivers/os/unique_fd.h"

namespace roomcal::drivers {

namespace {

constexpr std::string_view kClass = "/class/video4linux";

int result_of(long result) { return result < 0 ? -errno : static_cast<int>(result); }

// A path put together from parts; too long a one is empty, and then nothing is there.
class Path {
 public:
  Path(std::initializer_list<std::string_view> parts) {
    std::size_t size = 0;
    for (const std::string_view part : parts) {
      if (part.size() >= text_.size() - size) {
        text_[0] = 0;
        return;
      }
      std::memcpy(text_.data() + size, part.data(), part.size());
      size += part.size();
      text_[size] = 0;
    }
  }
  const char* text() const { return text_.data(); }

 private:
  std::array<char, 512> text_{};
};

// The first line of a sysfs file; empty if there is no such file.
template <std::size_t kCapacity>
FixedText<kCapacity> read_line(const Path& path) {
  const UniqueFd fd(::open(path.text(), O_RDONLY | O_CLOEXEC));
  std::array<char, kCapacity + 1> text;
  const ssize_t size = fd.valid() ? ::read(fd.get(), text.data(), text.size()) : 0;
  const std::string_view all(text.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
  return all.substr(0, all.find('\n'));
}

int write_text(const Path& path, std::string_view text) {
  const UniqueFd fd(::open(path.text(), O_WRONLY | O_CLOEXEC));
  return fd.valid() ? result_of(::write(fd.get(), text.data(), text.size())) : -errno;
}

// What getdents64(2) returns, entry by entry.
struct Entries {
  std::span<const std::byte> bytes;

  std::string_view next() {
    constexpr std::size_t kLength = 16, kName = 19;  // d_reclen and d_name in linux_dirent64
    uint16_t length = 0;
    std::memcpy(&length, bytes.data() + kLength, sizeof length);
    const auto* name = reinterpret_cast<const char*>(bytes.data() + kName);
    bytes = bytes.subspan(length);
    return name;
  }
};

// ".../devices/pci0000:00/.../1-2:1.0/video4linux/video0" without its ends.
std::string_view device_path(std::string_view link) {
  constexpr std::string_view kBefore = "devices/", kAfter = "/video4linux/";
  const std::size_t begin = link.find(kBefore), end = link.rfind(kAfter);
  if (begin == std::string_view::npos || end == std::string_view::npos || end < begin + kBefore.size()) return {};
  return link.substr(begin + kBefore.size(), end - begin - kBefore.size());
}

}  // namespace

int LinuxV4l2Kernel::open(std::string_view node) {
  return result_of(::open(Path{"/dev/", node}.text(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
}

void LinuxV4l2Kernel::close(int fd) { ::close(fd); }

int LinuxV4l2Kernel::ioctl(int fd, unsigned long request, void* argument) {
  return result_of(::ioctl(fd, request, argument));
}

int LinuxV4l2Kernel::map(int fd, std::size_t size, int64_t offset, std::span<const std::byte>& bytes) {
  void* address = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, fd, static_cast<off_t>(offset));
  if (address == MAP_FAILED) return -errno;
  bytes = {static_cast<const std::byte*>(address), size};
  return 0;
}

void LinuxV4l2Kernel::unmap(std::span<const std::byte> bytes) {
  ::munmap(const_cast<std::byte*>(bytes.data()), bytes.size());
}

int LinuxV4l2Kernel::poll(int fd, int64_t timeout_ns) {
  pollfd polled{fd, POLLIN | POLLPRI, 0};
  const timespec timeout = to_timespec(std::max<int64_t>(timeout_ns, 0));
  const int ready = ::ppoll(&polled, 1, &timeout, nullptr);
  return ready < 0 ? -errno : ready == 0 ? 0 : polled.revents;
}

int LinuxV4l2Kernel::list(std::span<NodeName> names) {
  const UniqueFd fd(::open(Path{sys_, kClass}.text(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!fd.valid()) return -errno;
  alignas(8) std::array<std::byte, 2048> chunk;
  std::size_t count = 0;
  for (;;) {
    const int size = result_of(::syscall(SYS_getdents64, fd.get(), chunk.data(), chunk.size()));
    if (size <= 0) return size < 0 ? size : static_cast<int>(count);
    for (Entries entries{std::span<const std::byte>(chunk).first(static_cast<std::size_t>(size))};
         !entries.bytes.empty();) {
      const std::string_view name = entries.next();
      if (name.substr(0, 5) != "video") continue;  // radios, VBI and sub-devices share the folder
      if (count < names.size()) names[count] = name;
      ++count;
    }
  }
}

int LinuxV4l2Kernel::describe(std::string_view name, VideoNode& node) {
  FixedText<255> link;
  if (const int read = read_link(Path{sys_, kClass, "/", name}.text(), link); read < 0) return read;
  node.name = name;
  node.path = device_path(link.view());
  node.title = read_line<63>({sys_, kClass, "/", name, "/name"});
  // `device` is the USB interface, one up is the device itself.
  node.serial = read_line<63>({sys_, kClass, "/", name, "/device/../serial"});
  const FixedText<15> index = read_line<15>({sys_, kClass, "/", name, "/index"});
  node.index = 0;
  std::from_chars(index.view().data(), index.view().data() + index.view().size(), node.index);
  return 0;
}

int LinuxV4l2Kernel::read_link(std::string_view path, FixedText<255>& target) {
  std::array<char, 255> text;
  const ssize_t size = ::readlink(Path{path}.text(), text.data(), text.size());
  if (size < 0) return -errno;
  target = std::string_view(text.data(), static_cast<std::size_t>(size));
  return 0;
}

int LinuxV4l2Kernel::reset_usb_device(std::string_view device) {
  const Path path{sys_, "/bus/usb/devices/", device, "/authorized"};
  if (const int off = write_text(path, "0"); off < 0) return off;
  return write_text(path, "1");
}

}  // namespace roomcal::drivers
