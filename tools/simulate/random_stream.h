#pragma once

#include "tools/common/random.h"

namespace roomcal::tools {

/// An independent stream of a seed: one per row or picture, so that results do not depend on the order of work.
/// The multipliers differ from the generator's own increment, so no stream is a shifted copy of another.
inline Random random_stream(uint64_t seed, uint64_t stream) {
  return Random(seed * 0xD1B54A32D192ED03u + stream * 0x8CB92BA72F3D8DD7u);
}

}  // namespace roomcal::tools
