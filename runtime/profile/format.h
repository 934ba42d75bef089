#pragma once

#include <cstddef>

#include "runtime/base/sealed.h"

namespace roomcal::profile {

inline constexpr std::size_t kMaxProfileBytes = 256 * 1024;

/// A device's profile in a file (`*.profile`): sealed (base/sealed.h), the payload is FlatBuffers, schema profile.fbs,
/// identifier "RPRO".
inline constexpr SealedKind kProfileKind = {
    .magic = {'r', 'o', 'o', 'm', 'p', 'r', 'o', '\n'},
    .version = 1,
    .max_bytes = kMaxProfileBytes,
    .too_short = "shorter than a profile's header: make it anew with `roomcal provision`",
    .absent = "not a device profile: make one with `roomcal provision`",
    .header_damaged = "the profile's header is damaged: copy it to the device again",
    .other_version = "the profile is of another version: make it anew with the `roomcal provision` of this firmware",
    .cut_short = "the profile is cut short: copy it to the device again",
    .damaged = "the profile's content is damaged: copy it to the device again",
};

}  // namespace roomcal::profile
