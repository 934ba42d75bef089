#pragma once

#include <string_view>

#include "drivers/v4l2/kernel.h"
#include "runtime/base/status.h"

namespace roomcal::drivers {

/// What a profile calls a camera by: what stays the same when it is plugged in again. Conditions, all of which hold:
///
/// | condition | holds for |
/// |---|---|
/// | `port:0000:00:14.0/*-2` | a device whose sysfs path has these parts, in this order. USB ports are named BUS-PORT;
/// `*` stands for any bus number, since those depend on the order of booting | | `serial:8A3F01` | a USB device with
/// this serial number | | `name:HD Webcam` | a node whose title in sysfs is this, or begins with it and a colon | |
/// `bus:usb-0000:00:14.0-2` | a device that gives this as its bus_info | | `index:0` | the n-th node of its device,
/// where a device has several that deliver images |
///
/// joined by " + ": `serial:8A3F01 + index:2`. Or the name of a link that udev keeps, alone: `/dev/v4l/by-path/...`,
/// `/dev/v4l/by-id/...`. A name like /dev/video0 is refused.
///
/// Nodes that deliver no images (metadata, output) are never meant.
class CameraKey {
 public:
  /// @return kInvalidArgument, naming what is wrong with it.
  static Status check(std::string_view key);

  /// @param key  that passed check(); outlives this.
  explicit CameraKey(std::string_view key) : key_(key) {}

  /// @param link  the node that the key's link points to; empty if the key is none.
  bool fits(const VideoNode& node, std::string_view link) const;
  /// @param bus_info  as the open device gives it.
  bool fits_bus(std::string_view bus_info) const;
  bool is_link() const;
  std::string_view text() const { return key_; }

 private:
  std::string_view key_;
};

}  // namespace roomcal::drivers
