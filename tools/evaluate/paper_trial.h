#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/evaluate/trust_shot.h"
#include "tools/simulate/stand.h"
#include "tools/sweep/load_sweeps.h"

namespace roomcal::tools {

/// One of the paper's devices in a simulated room, and what the runtime is told of it: its lenses as they are, its
/// mounting as drawn.
struct PaperStand {
  Stand stand;
  calib::Device device;
  ShotOptions options;
};
/// @param device  one of device_names(). The same seed gives the same stand.
PaperStand stand_in(const TrustRoom& room, const std::string& device, uint64_t seed);

/// What the sensors saw: rings with their noise, LiDARs as their own packets, decoded.
struct PaperShot {
  std::vector<std::vector<marker::Detection>> rings;  ///< per camera
  std::vector<std::vector<LoadedSweep>> sweeps;       ///< per LiDAR: one whole turn
};
PaperShot take_paper_shot(const TrustRoom& room, const PaperStand& stand, uint64_t seed);
/// One turn of each LiDAR.
std::vector<std::vector<LoadedSweep>> take_sweeps(const TrustRoom& room, const PaperStand& stand, uint64_t seed);

/// The runtime's view of sweeps, which must outlive it.
class SweepsView {
 public:
  explicit SweepsView(const std::vector<std::vector<LoadedSweep>>& sweeps);
  std::span<const calib::Sweeps> sweeps() const { return sweeps_; }

 private:
  std::vector<std::vector<lidar::Sweep>> views_;
  std::vector<calib::Sweeps> sweeps_;
};

/// T_to_from of two sensors against the truth.
struct PairError {
  std::string to, from;
  double position_m = 0, rotation_rad = 0;            ///< all directions
  double seen_position_m = 0, seen_rotation_rad = 0;  ///< without the axes that a report calls weak
  double baseline_m = 0;                              ///< length of the translation: found less true
  double nees = 0;

  /// Off by more than 5 predicted sigmas, and by more than 3 mm or 0.1 degree.
  bool wrong() const;
};

/// One shot, calibrated and held against the truth.
struct PaperTrial {
  Verdict verdict = Verdict::kFailService;
  std::string reason;            ///< the first one, where refused
  std::vector<PairError> pairs;  ///< of all sensors that were located, whatever the verdict
  double rms_px = 0;             ///< length of the reprojection error, all cameras
  double baseline_bound_m = 0;   ///< stereo rig at the level of observations only: baseline_bound_m()

  bool accepted() const { return may_write(verdict); }
  bool wrong() const;
  const PairError* find(const std::string& to, const std::string& from) const;
};
PaperTrial judge_outcome(const calib::Outcome& outcome, const PaperStand& stand);

/// A shot of a device through a session.
/// @param map          of the room, or of the room with errors
/// @param map_sigma_m  of these errors, per axis
PaperTrial run_paper_trial(const TrustRoom& room, const MapData& map, double map_sigma_m, const std::string& device,
                           uint64_t seed);

}  // namespace roomcal::tools
