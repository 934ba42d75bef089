#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "tools/common/random.h"
#include "tools/simulate/scene.h"

namespace roomcal::tools {

/// Where no paper may be, in a wall's own coordinates.
using KeepOut = std::vector<Eigen::AlignedBox2d>;

/// Puts pieces of paper where there is room for them: on the walls and the floor of a convex room, on every wall of
/// another.
class Paster {
 public:
  /// @param keep_out  of each wall; may be shorter than the list of walls
  Paster(Scene& scene, Random& random, std::vector<KeepOut> keep_out);

  /// At a random place and angle, which the decal is given. @return false if there is no place left.
  bool paste(Decal decal);

 private:
  std::size_t random_wall();
  bool fits(std::size_t wall, const Decal& decal) const;

  Scene& scene_;
  Random& random_;
  std::vector<KeepOut> keep_out_;
  std::size_t walls_;  ///< that take paper: the first of the scene's
};

}  // namespace roomcal::tools
