#pragma once

#include <cstdint>
#include <string_view>

#include "runtime/store/record.h"

namespace roomcal::store::test {

/// A valid record of a camera rig: `cameras` of them and, if there is room, one LiDAR.
/// @param seed  different seeds give different extrinsics, so that a mixed record would show.
Record sample_record(uint64_t seed, std::size_t cameras = 2, std::size_t lidars = 0);

/// The largest record that the format allows: every table and every text full.
Record largest_record();

/// Every field alike, bit by bit (covariances and evidence to the float that is stored).
bool same(const Record& a, const Record& b);

/// Alike in what was measured: everything but what the store stamps on it.
bool same_content(const Record& a, const Record& b);

}  // namespace roomcal::store::test
