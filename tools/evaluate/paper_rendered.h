#pragma once

#include "tools/evaluate/paper_table.h"
#include "tools/evaluate/trust_shot.h"

namespace roomcal::tools {

/// [P, IV-F] times per camera and LiDAR, and whether shots through pictures and packets come out as those at the level
/// of observations do. @param shots  of each device
PaperTable rendered_table(const TrustRoom& room, int shots);

}  // namespace roomcal::tools
