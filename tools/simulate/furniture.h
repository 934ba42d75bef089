#pragma once

#include "tools/common/random.h"
#include "tools/simulate/scene.h"

namespace roomcal::tools {

/// Puts so many pieces of furniture at the walls, in turn a table, a cabinet, a shelf with things on it and a duct from
/// floor to ceiling. They do not touch each other and hide what hangs behind them. Where a wall has no room left a
/// piece is left out.
void add_furniture(int pieces, Random& random, Scene& scene);

}  // namespace roomcal::tools
