#pragma once

#include <optional>
#include <vector>

#include "tools/bake/reconstruction.h"

namespace roomcal::tools {

/// The disc of a marker, from the ellipses of all its images.
struct MarkerShape {
  Vec3 normal_room = Vec3::Zero();  ///< unit, towards the cameras
  double radius_m = 0;
  double sigma_normal_rad = 0;
  double sigma_radius_m = 0;
  std::size_t ellipses = 0;
};

/// Normal and radius of a point such that its circle lies on all its measured outer ellipses: points of each ellipse
/// are cast onto the marker's plane and should come to lie radius_m from the centre. Robust; centre and poses held.
/// @param normal_start_room  where to start, e.g. the wall's normal; its sign does not matter.
/// @return nothing where fewer than three ellipses were measured or they do not agree.
/// Cost: some twenty Gauss-Newton rounds over 12 points an ellipse.
std::optional<MarkerShape> fit_shape(const Survey& survey, const Reconstruction& map,
                                     const std::vector<PointSight>& sights, const Vec3& p_room,
                                     const Vec3& normal_start_room);

}  // namespace roomcal::tools
