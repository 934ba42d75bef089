#pragma once

#include <string>

#include "runtime/lidar/bytes.h"

namespace roomcal::tools {

/// MD5 in hexadecimal, for comparing with published digests only. Source: RFC 1321.
std::string md5_hex(lidar::Bytes bytes);

}  // namespace roomcal::tools
