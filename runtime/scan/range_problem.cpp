#include "runtime/scan/range_problem.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "runtime/math/robust_loss.h"

namespace roomcal::scan {

namespace {

constexpr double kMinCosIncidence = 0.08;  // flatter than 85 degrees, a return says where the beam's rim was
constexpr double kBeyond = 5;              // sigmas behind a face that count as seen through it

/// Adds w J J' to the lower triangle: a third of the work of the full product.
void add_outer(double w, const Vec6& J, Mat66& A) {
  for (int c = 0; c < 6; ++c) {
    const double scaled = w * J[c];
    for (int r = c; r < 6; ++r) A(r, c) += scaled * J[r];
  }
}

double offset_information(const SensorModel& sensor) {
  return 1 / (sensor.beam_offset_sigma_m * sensor.beam_offset_sigma_m);
}

/// One pass over the points; what it needs for each of them, prepared.
class Gatherer {
 public:
  Gatherer(const Surface& surface, const SensorModel& sensor, const RangeState& state, const PassOptions& options,
           RangeSums& sums)
      : state_(state),
        options_(options),
        loss_(options.turn_over),
        variance_m2_(options.sigma_m * options.sigma_m),
        angle_variance_(sensor.angle_sigma_rad * sensor.angle_sigma_rad),
        sums_(sums) {
    posed_.set(surface, state.T_room_lidar);
  }

  void add(const Ray& ray) {
    ++sums_.valid;
    const RayHit hit = posed_.first_hit(ray.direction_lidar);
    if (hit.face == kNoFace) {
      if (hit.from_behind) contradict();
      return;
    }
    const auto face = static_cast<std::size_t>(hit.face);
    const RangePrediction at = predict_range(posed_.normal_lidar(face), posed_.height_m(face), ray.direction_lidar);
    if (at.cos_incidence < kMinCosIncidence) return;
    ++sums_.mapped;
    ++sums_.face[face].predicted;
    const double tan2 = 1 / (at.cos_incidence * at.cos_incidence) - 1;
    const double information = 1 / (variance_m2_ + angle_variance_ * tan2 * at.range_m * at.range_m);
    const double residual_m = ray.range_m - at.range_m - state_.offset_m[ray.beam];
    const double squared = residual_m * residual_m * information;
    const LossAndWeight robust = loss_(squared);
    sums_.loss += robust.loss;
    if (residual_m > 0 && squared > kBeyond * kBeyond) ++sums_.beyond;
    if (robust.weight >= RedescendingLoss::kOutlierWeight) {
      ++sums_.inliers;
      ++sums_.face[face].inliers;
      sums_.inlier_squares += squared;
    }
    if ((options_.mute >> face & 1U) == 0) weigh(ray, at, robust.weight * information, residual_m);
  }

 private:
  void contradict() {
    ++sums_.mapped;
    ++sums_.beyond;
    sums_.loss += loss_.max_loss();
  }

  void weigh(const Ray& ray, const RangePrediction& at, double weight, double residual_m) {
    add_outer(weight, at.J, sums_.A);
    sums_.g += weight * residual_m * at.J;
    RangeSums::Beam& beam = sums_.beam[ray.beam];
    beam.v += weight * at.J;
    beam.weight += weight;
    beam.residual += weight * residual_m;
    ++beam.points;
  }

  const RangeState& state_;
  const PassOptions& options_;
  RedescendingLoss loss_;
  double variance_m2_, angle_variance_;
  RangeSums& sums_;
  PosedSurface posed_;
};

}  // namespace

void gather(const Surface& surface, const SweepView& view, const SensorModel& sensor, const RangeState& state,
            const PassOptions& options, RangeSums& sums) {
  sums = {};
  Gatherer gatherer(surface, sensor, state, options, sums);
  for_each_ray(view, sensor, options.stride, [&](const Ray& ray) { gatherer.add(ray); });
  sums.A.triangularView<Eigen::StrictlyUpper>() = sums.A.transpose();
}

void gather(const Surface& surface, std::span<const Ray> rays, const SensorModel& sensor, const RangeState& state,
            const PassOptions& options, RangeSums& sums) {
  sums = {};
  Gatherer gatherer(surface, sensor, state, options, sums);
  for (std::size_t i = 0; i < rays.size(); i += fair_stride(options.stride)) gatherer.add(rays[i]);
  sums.A.triangularView<Eigen::StrictlyUpper>() = sums.A.transpose();
}

PoseInformation condense(const RangeSums& sums, const SensorModel& sensor, const RangeState& state) {
  PoseInformation pose;
  pose.T_hat = state.T_room_lidar;
  pose.information = sums.A;
  pose.gradient = sums.g;
  pose.chi2 = sums.inlier_squares;
  pose.measurements = static_cast<int>(sums.inliers);
  if (sensor.beam_offset_sigma_m <= 0) return pose;
  const double prior = offset_information(sensor);
  for (std::size_t k = 0; k < kMaxBeams; ++k) {
    const RangeSums::Beam& beam = sums.beam[k];
    if (beam.points == 0) continue;
    const double pivot = beam.weight + prior;
    pose.information -= beam.v * beam.v.transpose() / pivot;
    pose.gradient -= beam.v * ((beam.residual - prior * state.offset_m[k]) / pivot);
  }
  return pose;
}

void update_offsets(const RangeSums& sums, const SensorModel& sensor, const Vec6& xi, RangeState& state) {
  if (sensor.beam_offset_sigma_m <= 0) return;
  const double prior = offset_information(sensor);
  for (std::size_t k = 0; k < kMaxBeams; ++k) {
    const RangeSums::Beam& beam = sums.beam[k];
    if (beam.points == 0) continue;
    state.offset_m[k] += (beam.residual - prior * state.offset_m[k] - beam.v.dot(xi)) / (beam.weight + prior);
  }
}

void add_prior(const PosePrior& prior, const SE3& T_room_lidar, Mat66& information, Vec6& gradient) {
  const Vec6 off = se3_log(prior.T_room_lidar.inverse() * T_room_lidar);
  const Mat66 J = se3_right_jacobian_inverse(off);
  const Mat66 weighted = prior.cov.llt().solve(J);
  information += J.transpose() * weighted;
  gradient -= weighted.transpose() * off;
}

}  // namespace roomcal::scan
