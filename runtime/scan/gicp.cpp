#include "runtime/scan/gicp.h"

#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "runtime/map/sample_surface.h"
#include "runtime/math/robust_loss.h"

namespace roomcal::scan {

namespace {

constexpr std::size_t kNeighbours = 20;  // Segal, section IV
constexpr double kTurnOver = 3;          // sigmas
constexpr double kNarrower = 0.8;        // reach from round to round
constexpr double kMinPivot = 1e-9;

/// Direction in which the neighbours of a point scatter least.
Eigen::Vector3f normal_at(const Eigen::Vector3f& p, const KdTree& tree, std::span<const Eigen::Vector3f> points) {
  std::array<KdTree::Near, kNeighbours> near;
  const std::size_t count = tree.nearest(p, near);
  Mat33 scatter = Mat33::Zero();
  Vec3 mean = Vec3::Zero();
  for (std::size_t i = 0; i < count; ++i) mean += (points[near[i].index] - p).cast<double>();
  mean /= static_cast<double>(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 arm = (points[near[i].index] - p).cast<double>() - mean;
    scatter += arm * arm.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Mat33> axes;
  axes.computeDirect(scatter);
  return axes.eigenvectors().col(0).cast<float>();
}

/// The sweep as clouds are: points with normals.
struct Source {
  std::span<Eigen::Vector3f> points_lidar, normals_lidar;
  std::span<uint16_t> beams;
  std::size_t count = 0;
};

Status make_source(const SweepView& view, const SensorModel& sensor, Arena& scratch, Source& source) {
  source.points_lidar = scratch.allocate<Eigen::Vector3f>(kGicpPoints);
  source.normals_lidar = scratch.allocate<Eigen::Vector3f>(kGicpPoints);
  source.beams = scratch.allocate<uint16_t>(kGicpPoints);
  if (source.points_lidar.empty() || source.normals_lidar.empty() || source.beams.empty()) {
    return out_of_arena("scan: scratch arena too small, see gicp_scratch_bytes()");
  }
  const std::size_t stride = (view.point_count() + kGicpPoints - 1) / kGicpPoints;
  for_each_block(view, sensor, std::max<std::size_t>(1, stride), [&](const RayBlock& block) {
    for (std::size_t i = 0; i < block.count && source.count < kGicpPoints; ++i) {
      source.beams[source.count] = block.beam[i];
      source.points_lidar[source.count++] = block.range_m[i] * block.direction_lidar(i).cast<float>();
    }
  });
  if (source.count < kNeighbours) return {StatusCode::kTooFew, "scan: too few usable points in the sweep"};
  const std::span<const Eigen::Vector3f> points = source.points_lidar.first(source.count);
  const Result<KdTree> tree = KdTree::build(points, scratch);
  if (!tree.ok()) return tree.status();
  for (std::size_t i = 0; i < source.count; ++i) {
    source.normals_lidar[i] = normal_at(points[i], tree.value(), points);
  }
  return ok_status();
}

/// Sums of one round, whitened.
struct GicpSums {
  Mat66 G = Mat66::Zero();
  Vec6 g = Vec6::Zero();
  Mat66 noise = Mat66::Zero();           ///< of the gradient by independent range errors of 1 m
  std::array<Vec6, kMaxBeams> offset{};  ///< of the gradient by 1 m on a whole beam
  double squares_m2 = 0;
  uint32_t pairs = 0;

  GicpSums() { offset.fill(Vec6::Zero()); }
};

void gather_pairs(const GicpTarget& target, const Source& source, const SE3& T, double reach_m, double sigma_m,
                  double along_over_across, GicpSums& sums) {
  const RedescendingLoss loss(std::max(kTurnOver, reach_m / sigma_m));
  // (C_map + C_lidar) / sigma^2 = a I - (a - 1)/2 (n n' + m m'), a = along_over_across^2.
  const double a = along_over_across * along_over_across;
  const Eigen::Matrix3f R = T.R.cast<float>();
  const Eigen::Vector3f t = T.t.cast<float>();
  for (std::size_t i = 0; i < source.count; ++i) {
    KdTree::Near near;
    if (!target.tree().nearest(R * source.points_lidar[i] + t, static_cast<float>(reach_m), near)) continue;
    const Vec3 p = source.points_lidar[i].cast<double>();
    const Vec3 n = T.R.transpose() * target.normals_room()[near.index].cast<double>();
    const Vec3 m = source.normals_lidar[i].cast<double>();
    const Vec3 e = p - T.R.transpose() * (target.points_room()[near.index].cast<double>() - T.t);
    const Mat33 C = a * Mat33::Identity() - (a - 1) / 2 * (n * n.transpose() + m * m.transpose());
    const Mat33 W = C.inverse() / (sigma_m * sigma_m);
    const double weight = loss(e.dot(W * e)).weight;
    Eigen::Matrix<double, 3, 6> J;  // of e, turned into the sensor's frame, by a right perturbation
    J << Mat33::Identity(), -hat(p);
    const Eigen::Matrix<double, 6, 3> JW = weight * J.transpose() * W;
    sums.G += JW * J;
    sums.g -= JW * e;
    const Vec6 by_range = JW * p.normalized();
    sums.noise += by_range * by_range.transpose();
    sums.offset[source.beams[i]] += by_range;
    const double across_m = n.dot(e);
    sums.squares_m2 += across_m * across_m;
    ++sums.pairs;
  }
}

Mat66 covariance_of(const GicpSums& sums, const SensorModel& sensor, const Mat66& G_inverse) {
  Mat66 S = sensor.sigma_m * sensor.sigma_m * sums.noise;
  for (const Vec6& beam : sums.offset) {
    S += sensor.beam_offset_sigma_m * sensor.beam_offset_sigma_m * beam * beam.transpose();
  }
  return G_inverse * S * G_inverse;
}

Status check_start(const SensorModel& sensor, const SE3& start, const GicpOptions& options) {
  const bool good = start.R.allFinite() && start.t.allFinite() && sensor.sigma_m > 0 &&
                    sensor.beam_offset_sigma_m >= 0 && options.along_over_across >= 1 && options.rounds >= 1 &&
                    options.reach_m > 0 && options.final_reach_m > 0;
  return good ? ok_status() : Status{StatusCode::kInvalidArgument, "scan: GICP's start, sigmas or options are none"};
}

}  // namespace

std::size_t GicpTarget::bytes(std::size_t points) {
  // sample_surface()'s points stay in the arena below the cloud.
  return points * (2 * sizeof(Eigen::Vector3f) + sizeof(map::SurfacePoint)) + KdTree::bytes(points) + 64;
}

Result<GicpTarget> GicpTarget::build(const map::RoomMap& map, double spacing_m, Arena& permanent) {
  std::span<map::SurfacePoint> samples;
  ROOMCAL_TRY(map::sample_surface(map, spacing_m, permanent, samples));
  if (samples.empty()) return Status{StatusCode::kTooFew, "scan: the map has no plane with an outline"};
  GicpTarget target;
  target.points_room_ = permanent.allocate<Eigen::Vector3f>(samples.size());
  target.normals_room_ = permanent.allocate<Eigen::Vector3f>(samples.size());
  if (target.points_room_.empty() || target.normals_room_.empty()) {
    return out_of_arena("scan: permanent arena too small for the dense map");
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    target.points_room_[i] = samples[i].p_room;
    target.normals_room_[i] = map.plane(samples[i].plane).normal_room.cast<float>();
  }
  const Result<KdTree> tree = KdTree::build(target.points_room_, permanent);
  if (!tree.ok()) return tree.status();
  target.tree_ = tree.value();
  return target;
}

Result<GicpTarget> GicpTarget::from_cloud(std::span<const Eigen::Vector3f> points_room, Arena& permanent) {
  if (points_room.size() < kNeighbours) return Status{StatusCode::kTooFew, "scan: too few points for a dense map"};
  GicpTarget target;
  target.points_room_ = permanent.allocate<Eigen::Vector3f>(points_room.size());
  target.normals_room_ = permanent.allocate<Eigen::Vector3f>(points_room.size());
  if (target.points_room_.empty() || target.normals_room_.empty()) {
    return out_of_arena("scan: permanent arena too small for the dense map");
  }
  for (std::size_t i = 0; i < points_room.size(); ++i) {
    if (!points_room[i].allFinite()) return Status{StatusCode::kInvalidArgument, "scan: a point that is not finite"};
    target.points_room_[i] = points_room[i];
  }
  const Result<KdTree> tree = KdTree::build(target.points_room_, permanent);
  if (!tree.ok()) return tree.status();
  target.tree_ = tree.value();
  for (std::size_t i = 0; i < points_room.size(); ++i) {
    target.normals_room_[i] = normal_at(target.points_room_[i], target.tree_, target.points_room_);
  }
  return target;
}

std::size_t gicp_scratch_bytes() {
  return kGicpPoints * (2 * sizeof(Eigen::Vector3f) + sizeof(uint16_t)) + KdTree::bytes(kGicpPoints) + 64;
}

Status register_by_gicp(const GicpTarget& target, const SweepView& view, const SensorModel& sensor,
                        const SE3& start_T_room_lidar, const GicpOptions& options, Arena& scratch, GicpResult& result) {
  ROOMCAL_TRY(check_start(sensor, start_T_room_lidar, options));
  if (target.points_room().empty()) return {StatusCode::kInvalidArgument, "scan: GICP without a dense map"};
  const Arena::Scope scope(scratch);
  Source source;
  ROOMCAL_TRY(make_source(view, sensor, scratch, source));
  const double sigma_m = std::hypot(sensor.sigma_m, sensor.beam_offset_sigma_m);
  GicpResult found;
  found.T_room_lidar = start_T_room_lidar;
  double reach_m = options.reach_m;
  for (; found.rounds < options.rounds && !found.converged; ++found.rounds) {
    GicpSums sums;
    gather_pairs(target, source, found.T_room_lidar, reach_m, sigma_m, options.along_over_across, sums);
    if (sums.pairs < options.min_pairs) return {StatusCode::kTooFew, "scan: too few points of the sweep near the map"};
    const Eigen::LDLT<Mat66> solver(sums.G);
    if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > kMinPivot * solver.vectorD().maxCoeff())) {
      return {StatusCode::kDegenerate, "scan: the sweep's points do not fix a pose"};
    }
    const Vec6 xi = solver.solve(sums.g);
    found.T_room_lidar = found.T_room_lidar * se3_exp(xi);
    found.pairs = sums.pairs;
    found.rms_m = std::sqrt(sums.squares_m2 / sums.pairs);
    found.cov = covariance_of(sums, sensor, solver.solve(Mat66::Identity()));
    const bool narrow = reach_m <= options.final_reach_m;
    found.converged = narrow && xi.cwiseAbs().maxCoeff() < options.converged_m;
    reach_m = std::max(options.final_reach_m, kNarrower * reach_m);
  }
  result = found;
  return ok_status();
}

}  // namespace roomcal::scan
