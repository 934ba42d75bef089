#pragma once

#include "tools/common/random.h"
#include "tools/simulate/scene.h"

namespace roomcal::tools {

// What may have become of a room since its map was made, or while nobody looked. All of them take a room without
// drawn walls; none changes which markers the map has.

/// So many of the sheets hang elsewhere, each by `shift_m` along its wall.
void move_sheets(double share, double shift_m, Random& random, Scene& scene);

/// The light has failed in half of the room: beyond an upright plane through its middle.
void darken_half(Random& random, Scene& scene);

/// A mirror, half a metre to 1.2 m wide, hangs on a wall. Sheets that were there are gone.
void hang_mirror(Random& random, Scene& scene);

/// A door in a wall stands open into the room by 20 to 100 degrees, its sheets with it; behind is a dark corridor.
/// Sheets across its frame are gone.
void open_door(Random& random, Scene& scene);

/// Somebody stands in the room: legs, trunk and head as boxes.
void stand_operator(Random& random, Scene& scene);

}  // namespace roomcal::tools
