#include "board/common/packet_driver.h"

namespace roomcal::board {

namespace {

/// The longest packet of a model, and how many come a second at its highest rate; 0: not known here.
struct Traffic {
  uint32_t max_payload = 1472;
  uint32_t packets_per_second = 2000;
};

Traffic traffic_of(lidar::Model model) {
  if (model == lidar::Model::kVlp16) return {1206, 1508};  // 63-9243: 754, twice in dual return
  switch (info(model).family) {
    case lidar::Family::kVelodyne:
      return {1206, 3620};  // HDL-32E and VLP-32C in dual return
    case lidar::Family::kHesai:
      return {1472, 7200};  // QT128 in dual return
    case lidar::Family::kOuster:
      return {24'896, 2560};  // 128 beams, legacy profile; at 2048 x 10: 1280
    case lidar::Family::kRobosense:
      return {1248, 1800};
    case lidar::Family::kLivox:
      return {1400, 2200};
    case lidar::Family::kPepperlFuchs:
      return {1472, 1000};
  }
  return {};
}

drivers::UdpOptions udp_options(const profile::LidarProfile& lidar) {
  const profile::LidarWiring& w = lidar.wiring;
  const Traffic traffic = traffic_of(lidar.calibration.model);
  drivers::UdpOptions options;
  options.name = lidar.name;
  options.port = w.port != 0 ? w.port : info(lidar.calibration.model).data_port;
  options.local = w.local.view();
  options.group = w.group.view();
  options.interface = w.interface.view();
  options.sender = w.sender.view();
  options.sender_port = w.sender_port;
  options.max_payload = traffic.max_payload;
  options.packets_per_second = traffic.packets_per_second;
  return options;
}

drivers::ReplayPacketOptions replay_options(const profile::LidarProfile& lidar) {
  drivers::ReplayPacketOptions options;
  options.name = lidar.name;
  options.port = 0;  // whatever the recording holds
  return options;
}

}  // namespace

std::size_t PacketDriver::memory_bytes(const profile::LidarProfile& lidar, const drivers::ReplayCursor& replay) {
  return lidar.wiring.driver == profile::PacketDriver::kUdp
             ? drivers::UdpPacketSource::memory_bytes(udp_options(lidar))
             : drivers::ReplayPacketSource::memory_bytes(replay_options(lidar), replay);
}

void PacketDriver::choose(const profile::LidarProfile& lidar, const drivers::ReplayCursor& replay,
                          const ports::SystemClocks& clocks, std::span<std::byte> memory) {
  if (lidar.wiring.driver == profile::PacketDriver::kUdp) {
    source_ = &driver_.emplace<drivers::UdpPacketSource>(udp_options(lidar), memory);
  } else {
    source_ = &driver_.emplace<drivers::ReplayPacketSource>(replay_options(lidar), replay, clocks, memory);
  }
}

int PacketDriver::fd() const {
  const auto* udp = std::get_if<drivers::UdpPacketSource>(&driver_);
  return udp != nullptr ? udp->fd() : -1;
}

const char* to_string(profile::PacketDriver driver) { return driver == profile::PacketDriver::kUdp ? "udp" : "replay"; }

}  // namespace roomcal::board
