#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tools/align/triangle_match.h"

namespace roomcal::tools {

/// Three points of a set, each opposite to the edge of its place; edges descend.
struct PointTriangle {
  std::array<std::size_t, 3> corner{};
  std::array<double, 3> edge_m{};
  std::array<double, 3> sigma_m{};  ///< of the edges
};

/// Every triple of a point and two of its nearest neighbours with edges within the options' bounds, each once.
std::vector<PointTriangle> list_triangles(std::span<const SpacePoint> points, const TriangleMatchOptions& options);

}  // namespace roomcal::tools
