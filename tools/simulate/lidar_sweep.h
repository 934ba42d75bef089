#pragma once

#include <cstdint>
#include <vector>

#include "runtime/lidar/sweep.h"
#include "runtime/math/se3.h"
#include "tools/simulate/echo.h"
#include "tools/simulate/scene.h"

namespace roomcal::tools {

/// A spinning LiDAR's beams: all fire once in each of `columns` equal steps of azimuth.
struct BeamTable {
  std::vector<double> elevation_rad;  ///< one a beam, in the order of firing
  int columns = 1800;                 ///< firings of every beam in a turn
  double resolution_m = 0.002;        ///< of a reported range
  double divergence_rad = 0.003;      ///< width of a beam: what its reflectivity is averaged over
};

/// Velodyne VLP-16 at 10 turns a second: 16 beams from -15 to 15 degrees, 1800 x 16 = 28,800 firings.
/// Source: VLP-16 User Manual 63-9243, "Laser ID and elevation"; frame: x right, y at azimuth 0, z up.
BeamTable vlp16_beams();

/// What a real unit adds to the truth.
struct SweepFlaws : RangeFlaws {
  std::vector<double> beam_offset_m;  ///< constant of a beam; empty: none
  /// Azimuths (low, high), rad, from which nothing but something at 0.5 m returns; equal: nothing blocks the view.
  double blocked_from_rad = 0, blocked_to_rad = 0;
};

struct SimulatedSweep {
  std::vector<lidar::SweepPoint> points;
  uint16_t beam_count = 0;
  int64_t duration_ns = 0;

  lidar::Sweep view() const;
};

/// Casts sweeps in one room.
class SweepSimulator {
 public:
  /// @param scene  must outlive the simulator.
  explicit SweepSimulator(const Scene& scene) : caster_(scene) {}

  /// @throws ToolError for a table without beams or columns.
  SimulatedSweep sweep(const BeamTable& beams, const SweepFlaws& flaws, const SE3& T_room_lidar, uint64_t seed) const;
  const EchoCaster& caster() const { return caster_; }

 private:
  EchoCaster caster_;
};

/// Outlines of all surfaces of a room: walls, floor, ceiling and the faces of bodies; counter-clockwise from free
/// space.
std::vector<std::vector<Vec3>> surface_polygons(const Scene& scene);

}  // namespace roomcal::tools
