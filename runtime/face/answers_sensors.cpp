#include "runtime/face/answers.h"

namespace roomcal::face {

using console::Reply;

namespace {

double to_ms(int64_t ns) { return static_cast<double>(ns) * 1e-6; }

void tell_faults(const ports::ImageHealth& health, Reply& reply) {
  reply.open("faults");
  for (std::size_t i = 0; i < ports::kImageFaults; ++i)
    if (health.faults[i] > 0) reply.integer(to_string(static_cast<ports::ImageFault>(i)), health.faults[i]);
  reply.close();
}

void tell_camera(const CameraVitals& camera, Reply& reply) {
  reply.open(camera.name.view());
  reply.text("driver", camera.driver);
  if (!camera.key.empty()) reply.text("key", camera.key.view());
  reply.text("state", to_string(camera.health.state));
  reply.integer("width_px", camera.width_px);
  reply.integer("height_px", camera.height_px);
  reply.number("rate_hz", camera.rate_hz, 1, "Hz");
  reply.integer("images", static_cast<int64_t>(camera.health.images));
  reply.integer("lost", static_cast<int64_t>(camera.health.lost));
  reply.integer("superseded", static_cast<int64_t>(camera.health.superseded));
  reply.text("clock", to_string(camera.clock));
  reply.number("stamp_uncertainty_ms", to_ms(camera.uncertainty_ns), 3, "ms");
  reply.integer("clock_steps", camera.clock_steps);
  reply.integer("restarts", camera.health.restarts);
  reply.integer("reopens", camera.health.reopens);
  tell_faults(camera.health, reply);
  reply.close();
}

void tell_lidar(const LidarVitals& lidar, Reply& reply) {
  reply.open(lidar.name.view());
  reply.text("model", lidar.model.view());
  reply.text("driver", lidar.driver);
  reply.text("address", lidar.address.view());
  reply.flag("connected", lidar.connected);
  reply.number("sweep_rate_hz", lidar.sweep_rate_hz, 1, "Hz");
  reply.integer("packets", static_cast<int64_t>(lidar.packets.delivered));
  reply.integer("kernel_drops", static_cast<int64_t>(lidar.packets.kernel_drops));
  reply.integer("foreign", static_cast<int64_t>(lidar.packets.foreign));
  reply.integer("truncated", static_cast<int64_t>(lidar.packets.truncated));
  reply.integer("sweeps", lidar.sweeps.sweeps);
  reply.integer("lost", lidar.sweeps.lost);
  reply.integer("refused", int64_t{lidar.sweeps.unsupported} + lidar.sweeps.corrupt);
  reply.integer("duplicates", lidar.sweeps.duplicates);
  reply.integer("out_of_order", int64_t{lidar.sweeps.late_used} + lidar.sweeps.late_dropped);
  reply.close();
}

}  // namespace

Status Answers::sensors(Reply& reply) {
  desk_.examine(vitals_);
  for (const CameraVitals& camera : vitals_.cameras) tell_camera(camera, reply);
  for (const LidarVitals& lidar : vitals_.lidars) tell_lidar(lidar, reply);
  if (!vitals_.trigger.empty()) reply.text("trigger", vitals_.trigger.view());
  if (!vitals_.has_can) return ok_status();
  const ports::CanCounters& can = vitals_.can_counters;
  reply.open("can");
  reply.text("state", to_string(vitals_.can));
  reply.integer("received", static_cast<int64_t>(can.received));
  reply.integer("sent", static_cast<int64_t>(can.sent));
  reply.integer("send_refused", static_cast<int64_t>(can.send_refused));
  reply.integer("kernel_drops", static_cast<int64_t>(can.kernel_drops));
  reply.integer("error_messages", static_cast<int64_t>(can.error_messages));
  reply.integer("bus_offs", static_cast<int64_t>(can.bus_offs));
  reply.close();
  return ok_status();
}

}  // namespace roomcal::face
