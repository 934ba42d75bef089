#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "runtime/lidar/packet.h"

namespace roomcal::tools {

/// Finds RoboSense packets again in a recording that was cut into datagrams at the wrong places.
///
/// Converters from bags that take the message's layout wrong cut the bytes of its packets at a fixed pitch and drop a
/// fixed number of bytes at every cut. The packet's head (55 AA 05 5A) and the marks (FF EE) of its 12 blocks show
/// where packets are and how many bytes are missing at the cuts; what is missing stays missing: channels that a cut
/// touches get no range.
class Realigner {
 public:
  /// True for a datagram of a packet's size that does not begin as one.
  static bool torn(lidar::Bytes payload);
  void add(lidar::Bytes payload);

  /// Hands over every packet that was found, in order.
  void deliver(const std::function<void(lidar::Bytes)>& take) const;

 private:
  std::vector<std::vector<std::byte>> pieces_;
};

}  // namespace roomcal::tools
