#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "runtime/scan/locate_by_gicp.h"
#include "tools/common/files.h"
#include "tools/common/random.h"
#include "tools/simulate/lidar_sweep.h"
#include "tools/simulate/scene.h"

namespace roomcal::tools {

/// A room to locate LiDARs in: its truth and the surface that the runtime makes of it.
class LidarRoom {
 public:
  /// 3 x 4 x 2.7 m with a pillar, all planes known.
  explicit LidarRoom(uint64_t seed, bool pillar = true, const Vec3& size_m = Vec3(3, 4, 2.7), int markers = 340);

  const Scene& scene() const { return *scene_; }
  const SweepSimulator& simulator() const { return *simulator_; }
  const scan::Surface& surface() const { return surface_; }
  /// The same surface as points, 5 cm apart.
  const scan::GicpTarget& dense() const { return dense_; }

 private:
  void densify(const std::vector<std::vector<Vec3>>& outlines);

  std::unique_ptr<Scene> scene_;
  std::unique_ptr<SweepSimulator> simulator_;
  std::vector<std::byte> bytes_;
  scan::Surface surface_;
  std::vector<std::byte> dense_bytes_;
  scan::GicpTarget dense_;
};

/// How a sensor is held.
enum class Tilt : uint8_t { kUpright, kTilted, kSteep };
const char* to_string(Tilt tilt);

/// What the best possible estimate scatters by, beam offsets unknown with their prior.
struct PoseBound {
  double position_m = 0;  ///< root of the summed variances of the three axes
  double rotation_rad = 0;
  bool observable() const { return position_m < 0.003 && rotation_rad < deg_to_rad(0.15); }
};

enum class LidarMethod : uint8_t { kRayCast, kGicp };

struct LidarTrialSpec {
  LidarMethod method = LidarMethod::kRayCast;
  Tilt tilt = Tilt::kUpright;
  uint64_t seed = 1;
  double sigma_m = 0.015;
  double beam_offset_sigma_m = 0.010;
  double prior_error_m = 0.2, prior_error_deg = 10;  ///< length, in a random direction
  bool prior = true;
  bool use_reflectivity = true;
};

/// Error of a location with the axes that its report calls weak taken out.
struct ObservedError {
  double position_m = 0;
  double rotation_rad = 0;
};
ObservedError observed_error(const scan::Location& location, const SE3& T_room_lidar);

struct LidarTrial {
  LidarTrialSpec spec;
  PoseBound bound;
  SE3 T_room_lidar;  ///< truth
  scan::Location location;
  double position_error_m = 0;  ///< all axes
  double rotation_error_rad = 0;
  ObservedError observed;
  double nees = 0;
  double locate_ms = 0;

  bool right() const { return observed.position_m < 0.03 && observed.rotation_rad < deg_to_rad(0.5); }
  bool located() const { return location.outcome == scan::LocateOutcome::kLocated; }
  bool wrong() const { return located() && !right(); }
};

/// A pose at random: half a metre off walls and pillar at least.
SE3 random_lidar_pose(const Scene& scene, Tilt tilt, Random& random);

/// Cramer-Rao bound from numeric derivatives of the simulator's own rays (every fourth, scaled).
PoseBound pose_bound(const Scene& scene, const BeamTable& beams, const SE3& T_room_lidar, double sigma_m,
                     double beam_offset_sigma_m);

/// What a trial gives to whoever is to locate the sensor.
struct LidarTrialSetup {
  SE3 T_room_lidar;  ///< truth
  PoseBound bound;
  SimulatedSweep sweep;
  scan::PosePrior prior;
  scan::SensorModel sensor;
};
LidarTrialSetup set_up_lidar_trial(const LidarRoom& room, const LidarTrialSpec& spec);

/// Errors of a location in a trial.
LidarTrial judge_lidar_trial(const LidarTrialSpec& spec, const LidarTrialSetup& setup, const scan::Location& location,
                             double locate_ms);

/// Simulates a sweep and locates it.
LidarTrial run_lidar_trial(const LidarRoom& room, const LidarTrialSpec& spec);

/// Time that this thread was on a core: other work on the machine does not count.
double thread_cpu_ms();

}  // namespace roomcal::tools
