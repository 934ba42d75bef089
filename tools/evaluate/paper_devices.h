#pragma once

#include "tools/evaluate/paper_runs.h"
#include "tools/evaluate/paper_table.h"

namespace roomcal::tools {

/// [P, tables III to V]: every pair of sensors of the four devices from one shot, with an exact map.
PaperTable devices_table(const PaperRooms& rooms, int shots);

}  // namespace roomcal::tools
