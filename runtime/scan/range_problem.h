#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/status.h"
#include "runtime/math/pose_information.h"
#include "runtime/scan/ray_block.h"
#include "runtime/scan/surface.h"

namespace roomcal::scan {

/// Pose and range offsets of one LiDAR.
struct RangeState {
  SE3 T_room_lidar;
  std::array<double, kMaxBeams> offset_m{};  ///< measured range = true range + offset
};

/// Gaussian knowledge of a pose from elsewhere: nominal mounting and located cameras.
struct PosePrior {
  SE3 T_room_lidar;
  Mat66 cov = Mat66::Identity();  ///< right perturbation, positive definite
};

/// What one pass over the points gathers.
struct RangeSums {
  /// Of one beam: derivative of its offset against the pose, its own weight, its weighted residuals.
  struct Beam {
    Vec6 v = Vec6::Zero();
    double weight = 0;
    double residual = 0;
    uint32_t points = 0;
  };
  struct FaceCount {
    uint32_t predicted = 0;  ///< points that should lie on it
    uint32_t inliers = 0;
    double evidence = 0;  ///< how much better it explains them than the plane behind it would, sigmas^2; if asked for
  };

  Mat66 A = Mat66::Zero();  ///< pose x pose, whitened
  Vec6 g = Vec6::Zero();
  std::array<Beam, kMaxBeams> beam{};
  std::array<FaceCount, kMaxFaces> face{};
  double loss = 0;            ///< robust cost of the points with a prediction, sigmas^2
  double inlier_squares = 0;  ///< sigmas^2
  uint32_t valid = 0;         ///< usable points
  uint32_t mapped = 0;        ///< of these, with a face on their way
  uint32_t inliers = 0;
  uint32_t beyond = 0;  ///< measured well behind the face, or through the back of one: seen through a wall
};

struct PassOptions {
  double sigma_m = 0.015;
  double turn_over = 3;   ///< of the robust loss, sigmas
  uint64_t mute = 0;      ///< bits of faces whose points carry no weight
  bool evidence = false;  ///< whether FaceCount::evidence is wanted
};

/// Loss of a ray that nothing is predicted for: half-way between explained and contradicted.
inline constexpr double kUnmappedLoss = 9;

/// One pass over every stride-th point: association by ray casting at the state, residuals, derivatives, sums.
/// Cost: some 15 ns a point for a room of ten faces; no memory.
void gather(const Surface& surface, const SweepView& view, std::size_t stride, const SensorModel& sensor,
            const RangeState& state, const PassOptions& options, RangeSums& sums);

/// The same over rays that were read before.
void gather(const Surface& surface, std::span<const RayBlock> rays, const SensorModel& sensor, const RangeState& state,
            const PassOptions& options, RangeSums& sums);

/// Robust cost of rays at a state, sigmas^2; those that nothing is predicted for count kUnmappedLoss. A third of the
/// work of gather().
double total_loss(const Surface& surface, std::span<const RayBlock> rays, const SensorModel& sensor,
                  const RangeState& state, const PassOptions& options);

/// The pose's normal equations with the beam offsets eliminated (Schur complement), offset prior included.
PoseInformation condense(const RangeSums& sums, const SensorModel& sensor, const RangeState& state);

/// Offsets that go with a pose step xi, added to the state's.
void update_offsets(const RangeSums& sums, const SensorModel& sensor, const Vec6& xi, RangeState& state);

/// Adds a Gaussian prior at the state's pose.
void add_prior(const PosePrior& prior, const SE3& T_room_lidar, Mat66& information, Vec6& gradient);

}  // namespace roomcal::scan
