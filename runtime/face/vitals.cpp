#include "runtime/face/vitals.h"

#include "runtime/base/reason.h"

namespace roomcal::face {

namespace {

constexpr int64_t kQuiet_ns = 2'000'000'000;  // a LiDAR that turns at 5 Hz has sent ten sweeps in that time

}  // namespace

Reason complaint(const CameraVitals& camera, int64_t /*now_ns*/) {
  const ports::ImageHealth& health = camera.health;
  if (health.state == ports::SourceState::kStreaming) return {};
  const Name who(camera.name);
  return make_reason("%.*s: %s (%s): %s", who.length, who.text, to_string(health.last_fault), to_string(health.state),
                     remedy(health.last_fault));
}

Reason complaint(const LidarVitals& lidar, int64_t now_ns) {
  const Name who(lidar.name);
  if (!lidar.connected)
    return make_reason("%.*s: its network interface is not there: see `ip link` and `ip address`; it is looked for",
                       who.length, who.text);
  if (lidar.last_packet_ns == 0)
    return make_reason("%.*s: no packet has come yet: check its power, its cable and the address that it sends to",
                       who.length, who.text);
  if (now_ns - lidar.last_packet_ns > kQuiet_ns)
    return make_reason("%.*s: no packet for %.0f s: check its power and its cable", who.length, who.text,
                       static_cast<double>(now_ns - lidar.last_packet_ns) * 1e-9);
  if (lidar.sweeps.packets == 0 && lidar.sweeps.unsupported > 0)
    return make_reason("%.*s: its packets are not of a %.*s: check the model in the profile", who.length, who.text,
                       static_cast<int>(lidar.model.view().size()), lidar.model.view().data());
  return {};
}

}  // namespace roomcal::face
