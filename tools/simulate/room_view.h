#pragma once

#include <memory>
#include <vector>

#include "runtime/camera/camera.h"
#include "runtime/math/se3.h"
#include "tools/simulate/lighting.h"
#include "tools/simulate/paint.h"
#include "tools/simulate/raster.h"
#include "tools/simulate/ray.h"

namespace roomcal::tools {

/// A scene with its paint and light worked out; shared by all the cameras in it. The scene must outlive it.
class LitScene {
 public:
  explicit LitScene(const Scene& scene);

  const Scene& scene() const { return scene_; }
  struct Skin {
    PaintedPlane paint;
    LightMap light;
  };
  const Skin& skin_of(const Hit& hit) const;
  /// Irradiance on white paper at a hit; for the exposure meter. Negative where there is no wall with decals.
  double paper_radiance(const Hit& hit, const Vec2& q) const;
  /// Radiance of a lamp's panel along a ray to the ceiling, or 0.
  double lamp_radiance(const Hit& hit, const Vec2& q) const;

 private:
  const Scene& scene_;
  std::vector<std::unique_ptr<Skin>> skins_;  ///< walls, then the bodies' faces
};

/// What one pixel sees of one surface.
class LitPatch {
 public:
  /// @param q  middle of the pixel. @param footprint  d q / d px, m per px
  LitPatch(const LitScene& lit, const Hit& hit, const Vec2& q, const Mat22& footprint);

  /// Radiance (albedo x irradiance) of a place, averaged across a sample.
  /// @param[out] edge_px  distance to the nearest printed edge
  double radiance(const Vec2& q, double sample_px, double& edge_px) const;

 private:
  const LitScene& lit_;
  const Hit& hit_;
  const LitScene::Skin& skin_;
  PaintPatch paint_;
};

/// The scene through one camera.
class RoomView final : public Radiance {
 public:
  RoomView(const LitScene& lit, const camera::Camera& camera, const SE3& T_room_cam);

  void sample(int x, int y, PixelSamples& samples) const override;

  /// Radiance that white paper has in this picture: the given share of it is darker.
  double paper_radiance_quantile(double share) const;

 private:
  bool rays_of(double x, double y, PixelRays& rays_room) const;
  /// Whether a corner of the room or the outline of a body crosses the pixel.
  bool has_outline(const Sight& sight) const;
  /// Whether the rim of a mirror or an opening does.
  bool has_rim(const PixelRays& rays_room, const Sight& sight) const;
  float sample_alone(const Vec3& ray_room, const Mat22& footprint) const;
  const LitScene& lit_;
  const camera::Camera& camera_;
  SE3 T_room_cam_;
};

}  // namespace roomcal::tools
