#include "runtime/scan/plane_pull.h"

#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "runtime/map/plane_error.h"
#include "runtime/math/robust_loss.h"

namespace roomcal::scan {

namespace {

using Mat63 = Eigen::Matrix<double, 6, 3>;

constexpr std::size_t kWanted = 4000;
constexpr double kTurnOver = 3;            // sigmas, as in the fine solution
constexpr double kMinCosIncidence = 0.08;  // likewise

struct FaceSums {
  Mat32 axes_room = Mat32::Zero();
  Mat63 by_pose = Mat63::Zero();  ///< sum w J P'
};
struct BeamSums {
  Vec6 by_pose = Vec6::Zero();  ///< sum w J
  double weight = 0;
};

/// A point on the face that it belongs to.
struct Fit {
  std::size_t face = kMaxFaces;
  double weight = 0;
  double speed = 0;  ///< n . direction; negative
  Vec3 p_room = Vec3::Zero();
};

class PullSums {
 public:
  static Status build(const Surface& surface, const SensorModel& sensor, const Location& location, Arena& scratch,
                      PullSums& sums) {
    sums.surface_ = &surface;
    sums.location_ = &location;
    sums.variance_m2_ = location.sigma_m * location.sigma_m;
    sums.angle_variance_ = sensor.angle_sigma_rad * sensor.angle_sigma_rad;
    const std::size_t faces = surface.faces().size();
    sums.face_ = scratch.allocate<FaceSums>(faces);
    sums.beam_ = scratch.allocate<BeamSums>(kMaxBeams);
    sums.coupling_ = scratch.allocate<Vec3>(kMaxBeams * faces);
    if (sums.face_.empty() || sums.beam_.empty() || sums.coupling_.empty())
      return out_of_arena("scan: scratch arena too small, see face_pull_scratch_bytes()");
    for (std::size_t i = 0; i < faces; ++i) sums.face_[i].axes_room = map::plane_axes(surface.faces()[i].normal_room);
    return ok_status();
  }

  void add(const lidar::SweepPoint& point, const Vec3& p_lidar) {
    const double range_m = p_lidar.norm();
    const Vec3 direction_lidar = p_lidar / range_m;
    const double true_range_m = range_m - location_->beam[point.beam].offset_m;
    const Fit fit = fit_to_face(direction_lidar, true_range_m);
    if (fit.face == kMaxFaces) return;
    const Vec3 n_lidar = location_->information.T_hat.R.transpose() * surface_->faces()[fit.face].normal_room;
    Vec6 J;
    J << -n_lidar / fit.speed, -(true_range_m / fit.speed) * direction_lidar.cross(n_lidar);
    const Vec2 in_plane = face_[fit.face].axes_room.transpose() * fit.p_room;
    const Vec3 P = -Vec3(1, in_plane.x(), in_plane.y()) / fit.speed;
    face_[fit.face].by_pose += fit.weight * J * P.transpose();
    coupling_[point.beam * face_.size() + fit.face] += fit.weight * P;
    beam_[point.beam].by_pose += fit.weight * J;
    beam_[point.beam].weight += fit.weight;
  }

  /// @param share  how many points each of those that were added stands for.
  Mat63 pull(std::size_t face, double share, double offset_sigma_m) const {
    Mat63 pull = share * face_[face].by_pose;
    if (offset_sigma_m <= 0) return pull;
    for (std::size_t k = 0; k < kMaxBeams; ++k) {
      if (beam_[k].weight == 0) continue;
      const double pivot = share * beam_[k].weight + 1 / (offset_sigma_m * offset_sigma_m);
      pull -= (share * beam_[k].by_pose) * (share * coupling_[k * face_.size() + face]).transpose() / pivot;
    }
    return pull;
  }

 private:
  /// The face that explains a return best. A return belongs to a face that it lies on: no ray has to be cast for that.
  Fit fit_to_face(const Vec3& direction_lidar, double range_m) const {
    const SE3& T = location_->information.T_hat;
    const Vec3 direction_room = T.R * direction_lidar;
    const RedescendingLoss loss(kTurnOver);
    Fit best;
    best.p_room = T.t + range_m * direction_room;
    double least = kTurnOver * kTurnOver;
    for (std::size_t i = 0; i < face_.size(); ++i) {
      const Face& face = surface_->faces()[i];
      const double speed = face.normal_room.dot(direction_room);
      if (speed > -kMinCosIncidence) continue;
      const double residual_m = (face.normal_room.dot(best.p_room) + face.d_m) / speed;
      const double tan2 = 1 / (speed * speed) - 1;
      const double information = 1 / (variance_m2_ + angle_variance_ * tan2 * range_m * range_m);
      const double squared = residual_m * residual_m * information;
      if (squared >= least || !inside(face, best.p_room)) continue;
      least = squared;
      best.face = i;
      best.speed = speed;
      best.weight = loss(squared).weight * information;
    }
    return best;
  }

  bool inside(const Face& face, const Vec3& p_room) const {
    for (const FaceEdge& edge : surface_->edges(face))
      if (edge.inward_room.dot(p_room) + edge.d_m < 0) return false;
    return true;
  }

  const Surface* surface_ = nullptr;
  const Location* location_ = nullptr;
  double variance_m2_ = 0, angle_variance_ = 0;
  std::span<FaceSums> face_;
  std::span<BeamSums> beam_;
  std::span<Vec3> coupling_;  ///< sum w P of a beam and a face
};

bool is_usable(const lidar::SweepPoint& point, const Vec3& p_lidar, const SensorModel& sensor) {
  const double range_m = p_lidar.norm();
  return range_m >= sensor.min_range_m && range_m <= sensor.max_range_m && point.beam < kMaxBeams;  // NaN: no
}

/// Odd and no multiple of five, so that it shares no factor with the beam counts of real sensors.
std::size_t stride_over(std::span<const lidar::Sweep> sweeps) {
  std::size_t points = 0;
  for (const lidar::Sweep& sweep : sweeps) points += sweep.points.size();
  std::size_t stride = (points / kWanted) | 1U;
  while (stride > 1 && stride % 5 == 0) stride += 2;
  return stride;
}

}  // namespace

std::size_t face_pull_scratch_bytes() {
  return kMaxFaces * sizeof(FaceSums) + kMaxBeams * sizeof(BeamSums) + kMaxBeams * kMaxFaces * sizeof(Vec3) +
         3 * alignof(std::max_align_t);
}

Status find_face_pulls(const Surface& surface, std::span<const lidar::Sweep> sweeps, const SensorModel& sensor,
                       const Location& location, Arena& scratch, FacePulls& pulls) {
  pulls.clear();
  const Arena::Scope scope(scratch);
  PullSums sums;
  ROOMCAL_TRY(PullSums::build(surface, sensor, location, scratch, sums));
  const std::size_t stride = stride_over(sweeps);
  std::size_t next = 0;
  for (const lidar::Sweep& sweep : sweeps) {
    std::size_t i = next;
    for (; i < sweep.points.size(); i += stride)
      if (const Vec3 p_lidar = sweep.position_lidar(i); is_usable(sweep.points[i], p_lidar, sensor))
        sums.add(sweep.points[i], p_lidar);
    next = i - sweep.points.size();
  }
  for (std::size_t i = 0; i < surface.faces().size(); ++i) {
    const Mat63 pull = sums.pull(i, static_cast<double>(stride), sensor.beam_offset_sigma_m);
    if (!pull.isZero(0)) static_cast<void>(pulls.push_back({static_cast<uint32_t>(i), pull}));
  }
  return ok_status();
}

}  // namespace roomcal::scan
