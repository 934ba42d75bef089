#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "tools/map/map_data.h"

namespace roomcal::tools {

/// Numbers of the markers of one plane.
using PlaneMembers = std::vector<std::size_t>;

/// The plane through markers by least squares of their distances, and what is left of these (rms_m). The normal is of
/// either sign. @param members  three at least, not in one line.
void fit_plane(const std::vector<map::MapMarker>& markers, const PlaneMembers& members, map::MapPlane& plane);

/// Covariance of fit_plane()'s plane, by map/plane_error.h: each marker off by its own covariance along the normal, and
/// by what markers scatter beyond that, if it is significant: walls are not flat.
/// @return zero if it stays below a micrometre all over the markers: such a plane counts as exact.
Mat33 plane_covariance(const std::vector<map::MapMarker>& markers, const PlaneMembers& members,
                       const map::MapPlane& plane);

/// Fits every plane of three markers or more anew to where they are now, on the same side; covariance, outlines, lines
/// and corners follow.
void refit_planes(MapData& data);

}  // namespace roomcal::tools
