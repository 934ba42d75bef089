#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "runtime/base/fixed_text.h"

namespace roomcal::drivers {

/// "video3".
using NodeName = FixedText<15>;

/// A video node as sysfs knows it.
struct VideoNode {
  NodeName name;
  FixedText<255> path;   ///< of its device below /sys/devices: "pci0000:00/0000:00:14.0/usb1/1-2/1-2:1.0"
  FixedText<63> title;   ///< as its driver calls it: "HD Webcam: HD Webcam", "vivid-000-vid-cap"
  FixedText<63> serial;  ///< of USB devices that have one
  int index = 0;         ///< counts the nodes of one device
};

/// All that the V4L2 driver asks of the operating system; tests script its faults.
/// Calls return 0 or a positive result, -errno if they fail. No heap.
class V4l2Kernel {
 public:
  virtual ~V4l2Kernel() = default;

  /// Opens /dev/`node` for reading and writing, non-blocking, not inherited. @return a descriptor.
  virtual int open(std::string_view node) = 0;
  virtual void close(int fd) = 0;
  virtual int ioctl(int fd, unsigned long request, void* argument) = 0;
  /// Read-only. @param[out] bytes  the mapping, if it succeeds.
  virtual int map(int fd, std::size_t size, int64_t offset, std::span<const std::byte>& bytes) = 0;
  virtual void unmap(std::span<const std::byte> bytes) = 0;
  /// Waits for an image, an event or an error. @return the poll(2) bits that came; 0: none in that time.
  virtual int poll(int fd, int64_t timeout_ns) = 0;

  /// The system's video nodes. @return how many there are, which may be more than there is room for.
  virtual int list(std::span<NodeName> names) = 0;
  /// @return -ENOENT if there is none of this name any more.
  virtual int describe(std::string_view name, VideoNode& node) = 0;
  /// What a symbolic link says. @return -EINVAL if it is none.
  virtual int read_link(std::string_view path, FixedText<255>& target) = 0;
  /// Makes a USB device leave its port and come back. @param device  as sysfs names it: "1-2.3".
  virtual int reset_usb_device(std::string_view device) = 0;
};

}  // namespace roomcal::drivers
