#pragma once

#include <nlohmann/json.hpp>

#include "tools/map/map_data.h"

namespace roomcal::tools {

/// A micrometre, or a millionth: more digits would only make pages large.
double rounded(double value);
nlohmann::ordered_json rounded(const Vec3& v);

/// A map as pages draw it: markers [{id, p, n, r, sigma_mm, plane}] (n and r null where the map has none), planes
/// [{normal, d_m, rms_m, markers, outline}], lines [{from, to}], corners [p].
nlohmann::ordered_json room_json(const MapData& data);

}  // namespace roomcal::tools
