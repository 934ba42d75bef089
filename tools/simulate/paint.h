#pragma once

#include <cstdint>
#include <vector>

#include "tools/simulate/scene.h"

namespace roomcal::tools {

/// What is seen at a place of a plane.
struct Paint {
  double albedo = 0;
  double edge_px = 1e9;  ///< distance to the nearest edge of the print: nearer than a pixel asks for subsamples
};

/// A decal, ready to be looked at.
class PaintedDecal {
 public:
  explicit PaintedDecal(const Decal& decal);

  /// Its albedo over what is `below`, averaged across a sample.
  ///
  /// @param q          plane coordinates, m
  /// @param footprint  d q / d px, m per px
  /// @param sample_px  width of a sample in pixels. An edge is a straight line across it: with samples of 1/4 px the
  ///                   circles of a 15 px marker are off by 0.004 px in radius, and not at all in their centre.
  Paint over(const Paint& below, const Vec2& q, const Mat22& footprint, double sample_px) const;

 private:
  Decal decal_;
  Mat22 R_decal_plane_;
};

/// All the decals, joints and stains of a plane, with a grid to find them.
class PaintedPlane {
 public:
  PaintedPlane(const Plane& plane, uint64_t seed);

  Paint at(const Vec2& q, const Mat22& footprint, double sample_px) const;

 private:
  int cell_of(const Vec2& q) const;
  Paint background(const Vec2& q, const Mat22& footprint) const;

  const Plane& plane_;
  std::vector<PaintedDecal> decals_;
  uint64_t seed_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::vector<uint16_t>> decals_near_;  ///< per cell of kCell_m
};

}  // namespace roomcal::tools
