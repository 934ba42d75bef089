#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/lidar/model.h"

namespace roomcal::lidar {

/// When the lasers of a Hesai fire, relative to the time in the packet's tail, ns.
/// Sources: Hesai user manuals, "laser firing time" appendices, as facts also in tier4/nebula, pandar_*.hpp.
///
/// @param block  0-based, within the packet; of a multi-return group its first block.
/// @param blocks  of the packet. @param returns  1 to 3.
int32_t hesai_block_ns(Model model, std::size_t block, std::size_t blocks, std::size_t returns);

/// @param second_loop  QT128 only: its two firing sequences alternate.
int32_t hesai_channel_ns(Model model, std::size_t channel, bool second_loop);

/// The earliest hesai_channel_ns().
int32_t hesai_first_channel_ns(Model model);

/// Between packets, ns; 0: depends on the unit's settings.
int64_t hesai_interval_ns(Model model, std::size_t blocks, std::size_t returns);

}  // namespace roomcal::lidar
