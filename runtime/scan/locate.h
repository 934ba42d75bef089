#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/lidar/sweep.h"
#include "runtime/math/pose_information.h"
#include "runtime/scan/acceptance.h"
#include "runtime/scan/observability.h"
#include "runtime/scan/range_problem.h"
#include "runtime/scan/sensor_model.h"
#include "runtime/scan/surface.h"

namespace roomcal::scan {

struct LocateOptions {
  AcceptanceLimits accept;
  ObservabilityLimits observe;
  /// Mean loss (sigmas^2 a point) by which another place in the room must fit worse not to be a twin: 0.05 is a misfit
  /// of a fifth of a sigma, 3 mm, as much as a map may be wrong by.
  double twin_loss = 0.05;
  bool use_reflectivity = true;  ///< of the printed sheets: to tell twins apart and to close open axes
};

enum class LocateOutcome : uint8_t {
  kLocated,
  kAmbiguous,  ///< several places in the room fit equally; T_room_lidar is one of `twins`
  kRefused,    ///< `reason` says why; nothing else holds
};
const char* to_string(LocateOutcome outcome);

struct BeamOffset {
  double offset_m = 0;  ///< measured range = true range + offset
  double sigma_m = 0;   ///< the prior's where the beam has no points
  uint32_t points = 0;
};

/// One LiDAR in the room.
struct Location {
  LocateOutcome outcome = LocateOutcome::kRefused;
  const char* reason = "";  ///< one line with the remedy; empty if located
  int twins = 1;            ///< places that fit, this one included

  SE3 T_room_lidar;
  Mat66 cov = Mat66::Zero();  ///< with the prior, if there was one; open axes carry the unseen sigmas or the prior's
  /// Of the points alone, beam offsets eliminated, no prior: for a joint problem, which has its own priors.
  PoseInformation information;
  WeakDirections weak;  ///< judged on `information`, print edges included

  std::array<BeamOffset, kMaxBeams> beam{};
  std::size_t beam_count = 0;  ///< one more than the highest beam with points

  double rms_m = 0;    ///< of the inliers' range residuals
  double sigma_m = 0;  ///< of one range, as used: the sensor's, or what the sweep showed
  FitShares shares;
  double azimuth = 0;   ///< share of the sensor's horizon covered by points that fit
  uint32_t points = 0;  ///< usable
  uint32_t inliers = 0;
  uint32_t print_points = 0;  ///< whose reflectivity took part; 0: not used
};

/// Scratch that locate() needs, bytes; below 1 MiB whatever the sweep.
std::size_t locate_scratch_bytes();

/// Where the LiDAR stands in the room, from one sweep or several taken while it stood still.
///
///     sample -> planes -> coarse poses -> settle -> twins? -> refine with beam offsets, by evidence -> weakest axis ->
///     prints -> accept
///
/// The fine solution minimizes sum rho((range - offset[beam] - cast(T_room_lidar, beam))^2 / sigma^2) over pose and
/// offsets, with association by ray casting, which has no bias at edges.
/// @param prior  from nominal mounting and located cameras; null where there is none. It picks among twins and carries
///               axes that the sweep does not see; `information` stays free of it.
/// @return kOk with whatever outcome; kInvalidArgument (no sweep, a sensor or prior that is not one), kOutOfMemory.
/// Deterministic, no heap. Cost: 2 to 4 ms for 28,800 points in a room of ten planes, up to 10 ms where prints are
/// asked or there is no prior.
Status locate(const Surface& surface, std::span<const lidar::Sweep> sweeps, const SensorModel& sensor,
              const PosePrior* prior, const LocateOptions& options, Arena& scratch, Location& location);

}  // namespace roomcal::scan
