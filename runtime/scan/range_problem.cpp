#include "runtime/scan/range_problem.h"

#include <Eigen/Cholesky>

#include "runtime/scan/weigh_block.h"

namespace roomcal::scan {

namespace {

double offset_information(const SensorModel& sensor) {
  return 1 / (sensor.beam_offset_sigma_m * sensor.beam_offset_sigma_m);
}

WeighOptions weigh_options(const SensorModel& sensor, const RangeState& state, const PassOptions& options) {
  WeighOptions weigh;
  weigh.variance_m2 = static_cast<float>(options.sigma_m * options.sigma_m);
  weigh.angle_variance = static_cast<float>(sensor.angle_sigma_rad * sensor.angle_sigma_rad);
  weigh.turn_over = static_cast<float>(options.turn_over);
  for (std::size_t i = 0; i < kMaxFaces; ++i) weigh.face_weight[i] = (options.mute >> i & 1U) == 0 ? 1 : 0;
  weigh.face_weight[kNoFace] = 0;
  for (std::size_t k = 0; k < kMaxBeams; ++k) weigh.offset_m[k] = static_cast<float>(state.offset_m[k]);
  return weigh;
}

/// One pass over the points; what it needs for each block of them, prepared.
class Gatherer {
 public:
  Gatherer(const Surface& surface, const SensorModel& sensor, const RangeState& state, const PassOptions& options,
           RangeSums& sums)
      : posed_(surface, state.T_room_lidar),
        weigh_(weigh_options(sensor, state, options)),
        evidence_(options.evidence),
        sums_(sums) {
    sums_ = {};
  }

  void add(const RayBlock& block) {
    posed_.cast(block, hits_);
    weigh_block(posed_, block, hits_, weigh_, weighed_);
    add_block(weighed_, lanes_);
    count(block);
    if (evidence_) add_evidence(block);
  }

  void finish() {
    std::size_t which = 0;
    for (int c = 0; c < 6; ++c) {
      for (int r = c; r < 6; ++r) sums_.A(r, c) = sums_.A(c, r) = lanes_.total(which++);
      sums_.g[c] = lanes_.total(LaneSums::kProducts + static_cast<std::size_t>(c));
    }
    sums_.loss = lanes_.total(LaneSums::kLoss);
    sums_.inlier_squares = lanes_.total(LaneSums::kInlierSquares);
  }

 private:
  void count(const RayBlock& block) {
    sums_.valid += block.count;
    for (std::size_t i = 0; i < block.count; ++i) {
      const int32_t flags = weighed_.flags[i];
      sums_.beyond += (flags & kRayBeyond) != 0 ? 1U : 0U;
      // The back of a face counts as mapped, and as contradicted.
      sums_.mapped += (flags & (kRayMapped | kRayBeyond)) != 0 ? 1U : 0U;
      if ((flags & kRayMapped) == 0) continue;
      const uint32_t inlier = (flags & kRayInlier) != 0 ? 1U : 0U;
      RangeSums::FaceCount& face = sums_.face[static_cast<std::size_t>(hits_.face[i])];
      ++face.predicted;
      face.inliers += inlier;
      sums_.inliers += inlier;
      if (weighed_.weight[i] > 0) add_to_beam(i, sums_.beam[block.beam[i]]);
    }
  }

  void add_to_beam(std::size_t i, RangeSums::Beam& beam) {
    const auto weight = static_cast<double>(weighed_.weight[i]);
    for (std::size_t k = 0; k < 6; ++k) {
      beam.v[static_cast<Eigen::Index>(k)] += weight * static_cast<double>(weighed_.J[k][i]);
    }
    beam.weight += weight;
    beam.residual += weight * static_cast<double>(weighed_.residual_m[i]);
    ++beam.points;
  }

  void add_evidence(const RayBlock& block) {
    BlockHits behind;
    alignas(64) BlockFloats evidence;
    posed_.cast_behind(block, hits_, behind);
    weigh_evidence(block, behind, weigh_, weighed_, static_cast<float>(kUnmappedLoss), evidence);
    for (std::size_t i = 0; i < block.count; ++i) {
      if ((weighed_.flags[i] & kRayMapped) == 0) continue;
      sums_.face[static_cast<std::size_t>(hits_.face[i])].evidence += static_cast<double>(evidence[i]);
    }
  }

  PosedSurface posed_;
  WeighOptions weigh_;
  bool evidence_;
  RangeSums& sums_;
  LaneSums lanes_;
  BlockHits hits_;
  WeighedBlock weighed_;
};

}  // namespace

void gather(const Surface& surface, const SweepView& view, std::size_t stride, const SensorModel& sensor,
            const RangeState& state, const PassOptions& options, RangeSums& sums) {
  Gatherer gatherer(surface, sensor, state, options, sums);
  for_each_block(view, sensor, stride, [&](const RayBlock& block) { gatherer.add(block); });
  gatherer.finish();
}

void gather(const Surface& surface, std::span<const RayBlock> rays, const SensorModel& sensor, const RangeState& state,
            const PassOptions& options, RangeSums& sums) {
  Gatherer gatherer(surface, sensor, state, options, sums);
  for (const RayBlock& block : rays) gatherer.add(block);
  gatherer.finish();
}

double total_loss(const Surface& surface, std::span<const RayBlock> rays, const SensorModel& sensor,
                  const RangeState& state, const PassOptions& options) {
  const PosedSurface posed(surface, state.T_room_lidar);
  const WeighOptions weigh = weigh_options(sensor, state, options);
  BlockHits hits;
  WeighedBlock weighed;
  double total = 0;
  for (const RayBlock& block : rays) {
    posed.cast(block, hits);
    weigh_block(posed, block, hits, weigh, weighed);
    for (std::size_t i = 0; i < block.count; ++i) {
      total += weighed.flags[i] == 0 ? kUnmappedLoss : static_cast<double>(weighed.loss[i]);
    }
  }
  return total;
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
