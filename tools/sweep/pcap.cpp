#include "tools/sweep/pcap.h"

#include <fmt/core.h>

#include "tools/common/error.h"

namespace roomcal::tools {

PcapReader::PcapReader(const std::string& name, lidar::Bytes bytes)
    : fragments_(std::make_unique<lidar::IpFragments>()) {
  const Result<lidar::PcapHead> head = lidar::read_pcap_head(bytes);
  if (!head.ok()) throw ToolError(fmt::format("{}: {}", name, head.status().detail()));
  const Result<lidar::PcapReader> reader = lidar::PcapReader::open(bytes, *fragments_);
  if (!reader.ok())
    throw ToolError(fmt::format("{}: link type {}: {}", name, head.value().link_type, reader.status().detail()));
  reader_ = reader.value();
}

}  // namespace roomcal::tools
