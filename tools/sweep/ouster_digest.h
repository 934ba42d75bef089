#pragma once

#include <map>
#include <string>
#include <vector>

#include "runtime/lidar/calibration.h"
#include "tools/sweep/pcap.h"

namespace roomcal::tools {

/// MD5 of every field over all point packets of a recording: per packet the field as an array (rows x columns, row
/// after row, or columns) in the type that Ouster's SDK gives it. This is what its test captures carry as
/// `packet_hash`.
std::map<std::string, std::string> ouster_digests(const std::string& name, lidar::Bytes pcap,
                                                  const lidar::Calibration& calibration);

}  // namespace roomcal::tools
