#pragma once

#include <memory>
#include <vector>

#include "tools/common/random.h"
#include "tools/simulate/paint.h"
#include "tools/simulate/scene.h"

namespace roomcal::tools {

/// What a real sensor adds to every range.
struct RangeFlaws {
  double sigma_m = 0.015;         ///< of one range
  double dropout = 0;             ///< share of firings without a return
  bool mixed_pixels = false;      ///< a beam whose rim meets another surface returns something between
  double reflectivity_sigma = 3;  ///< of the reported reflectivity, percent
};

/// One pulse of light into the room.
struct Pulse {
  Vec3 origin_room = Vec3::Zero();
  Vec3 direction_room = Vec3::UnitX();  ///< unit
  double divergence_rad = 0.003;        ///< width of the beam: what its reflectivity is averaged over
  double offset_m = 0;                  ///< what this beam's ranges are off by, always
  bool blocked = false;                 ///< something stands half a metre before it
};

/// What came back of it.
struct Echo {
  double range_m = 0;               ///< from the pulse's origin; 0: nothing
  double reflectivity_percent = 0;  ///< albedo under the beam, as a calibrated sensor reports diffuse surfaces
};

/// Sends pulses into one room. Safe to call from several threads.
class EchoCaster {
 public:
  /// @param scene  must outlive the caster.
  explicit EchoCaster(const Scene& scene);

  /// Cost: about 1 us.
  Echo echo(const Pulse& pulse, const RangeFlaws& flaws, Random& random) const;

 private:
  double reflectivity_percent(const Plane& plane, const Pulse& pulse, double distance_m) const;
  double mixed_range_m(const Pulse& pulse, double range_m, Random& random) const;

  const Scene& scene_;
  std::vector<const Plane*> planes_;
  std::vector<std::unique_ptr<PaintedPlane>> skins_;
};

}  // namespace roomcal::tools
