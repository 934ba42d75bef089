#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tools/simulate/scene.h"

namespace roomcal::tools {

/// What is seen at a place of a plane.
struct Paint {
  double albedo = 0;
  double edge_px = 1e9;  ///< distance to the nearest edge of the print: nearer than a pixel asks for subsamples
};

/// A pixel's footprint in a decal's own axes: the same for all samples of the pixel.
struct DecalFootprint {
  Mat22 local;                    ///< d local / d px, m per px
  double across_m = 0, up_m = 0;  ///< width of a pixel along the decal's own axes
};

/// A decal, ready to be looked at.
class PaintedDecal {
 public:
  explicit PaintedDecal(const Decal& decal);

  /// What it adds to a place: its own albedo, and how much of the sample its paper covers.
  struct Layer {
    double paper = 0;
    double albedo = 0;
    double edge_px = 1e9;
  };

  /// False if it certainly is more than so many pixels away: most decals of a cell are out by this alone.
  bool near(const Vec2& q, const Mat22& footprint, double reach_px) const;
  DecalFootprint footprint_of(const Mat22& footprint) const;

  /// Averaged across a sample.
  ///
  /// @param q          plane coordinates, m
  /// @param footprint  of the whole pixel
  /// @param sample_px  width of a sample in pixels. An edge is a straight line across it: with samples of 1/4 px the
  ///                   circles of a 15 px marker are off by 0.004 px in radius, and not at all in their centre.
  /// @return false if it is more than two pixels away from it all
  bool look(const Vec2& q, const DecalFootprint& footprint, double sample_px, Layer& layer) const;

  /// The same over what is `below`. @param footprint  d q / d px, m per px
  Paint over(const Paint& below, const Vec2& q, const Mat22& footprint, double sample_px) const;

 private:
  Decal decal_;
  Mat22 R_decal_plane_;
};

class PaintPatch;

/// All the decals, joints and stains of a plane, with a grid to find them.
class PaintedPlane {
 public:
  /// @throws ToolError if more than kMostNear decals crowd around one place.
  PaintedPlane(const Plane& plane, uint64_t seed);

  static constexpr std::size_t kMostNear = 32;

 private:
  friend class PaintPatch;

  int cell_of(const Vec2& q) const;
  /// Albedo of the joint at q, or a negative number. @param[out] edge_px  distance to the nearest joint's edge
  double joint(const Vec2& q, const Vec2& spacing_m, double& edge_px) const;
  double stained_albedo(const Vec2& q) const;

  const Plane& plane_;
  std::vector<PaintedDecal> decals_;
  uint64_t seed_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::vector<uint16_t>> decals_near_;  ///< per cell of kCell_m
};

/// What one pixel sees of a painted plane: worked out once, looked at in one sample or in many.
class PaintPatch {
 public:
  /// @param q          middle of the pixel, plane coordinates, m
  /// @param footprint  d q / d px, m per px
  PaintPatch(const PaintedPlane& plane, const Vec2& q, const Mat22& footprint);

  /// @param q  within the pixel. @param sample_px  see PaintedDecal::look()
  Paint at(const Vec2& q, double sample_px) const;

 private:
  struct Near {
    const PaintedDecal* decal;
    DecalFootprint footprint;
  };
  const PaintedPlane& plane_;
  Vec2 spacing_m_;  ///< width of a pixel along the plane's axes
  std::array<Near, PaintedPlane::kMostNear> near_;
  std::size_t count_ = 0;
};

}  // namespace roomcal::tools
