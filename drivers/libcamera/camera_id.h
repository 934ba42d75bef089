#pragma once

#include <span>
#include <string>
#include <string_view>

#include "runtime/base/status.h"

namespace roomcal::drivers {

/// Which of libcamera's cameras a key means: the one of exactly this id, else the only one whose id has the key in it.
/// Ids are made of firmware paths or USB ports and outlive re-plugging: "/base/soc/i2c0mux/i2c@1/imx296@1a".
/// @return its index; kNotFound if the key fits none, or more than one.
Result<std::size_t> find_camera_id(std::span<const std::string> ids, std::string_view key);

}  // namespace roomcal::drivers
