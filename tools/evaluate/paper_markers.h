#pragma once

#include "tools/evaluate/paper_table.h"
#include "tools/evaluate/trust_shot.h"

namespace roomcal::tools {

/// [P, IV-G] rings against AprilTags on the same sheets: stereo rig, one image, rendered.
/// @param shots  places of the rig
PaperTable markers_table(const TrustRoom& room, int shots);

}  // namespace roomcal::tools
