#pragma once

#include "tools/evaluate/paper_table.h"
#include "tools/evaluate/trust_shot.h"

namespace roomcal::tools {

/// [P, III-A and IV-A]: maps of two surveys of one room with the stereo rig, against the true markers.
/// @param pairs  stereo image pairs of a survey
PaperTable maps_table(const TrustRoom& room, int pairs);

}  // namespace roomcal::tools
