#include "runtime/calib/held_out.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "runtime/calib/refine_jointly.h"
#include "runtime/rig/reprojection.h"

namespace roomcal::calib {

namespace {

constexpr int kEvery = 5;  // 20 %
constexpr std::size_t kMinKept = 8;
constexpr double kMedianOfSquare = 1.3862943611198906;  // chi-square with two degrees of freedom: 2 ln 2

bool is_held_out(const rig::RingObservation& ring) { return ring.landmark % kEvery == kEvery / 2; }

/// What one camera predicts with: where the kept markers put it, and its lens.
struct Predictor {
  const camera::Camera& camera;
  const SE3& T_room_cam;
  Mat66 cov_pose;
  Eigen::Matrix<double, 6, camera::kIntrinsicsCount> cov_pose_lens;
  camera::ParameterMatrix cov_lens;
  double sigma_floor_px;

  Predictor(const Session& session, const rig::RigSolution& kept, std::size_t number, std::size_t view)
      : camera(kept.lens_of(view) != nullptr ? kept.lens_of(view)->camera : session.device.cameras[number].camera),
        T_room_cam(kept.T_room_sensor[view]),
        cov_pose(kept.cov_block(view, view)),
        cov_pose_lens(decltype(cov_pose_lens)::Zero()),
        cov_lens(camera::ParameterMatrix::Zero()),
        sigma_floor_px(session.sigma_floor_px) {
    const rig::RefinedLens* lens = kept.lens_of(view);
    if (lens == nullptr) return;
    const auto number_of_lens = static_cast<std::size_t>(lens - kept.lenses.data());
    cov_pose_lens = kept.cov_pose_lens(view, number_of_lens);
    cov_lens = kept.cov_lens(number_of_lens);
  }

  /// Squared miss of one ring in its predicted sigmas; negative if it cannot be predicted.
  double squared_miss(const rig::RingObservation& ring, const rig::Landmark& landmark) const {
    rig::Reprojection at;
    if (!rig::reproject(camera, T_room_cam, landmark.p_room, ring.centre_px, at).ok()) return -1;
    Mat22 cov = ring.cov_px2 + at.J_pose * cov_pose * at.J_pose.transpose() +
                at.J_point * landmark.cov_m2 * at.J_point.transpose();
    const Mat22 cross = at.J_pose * cov_pose_lens * at.J_intrinsics.transpose();
    cov += cross + cross.transpose() + at.J_intrinsics * cov_lens * at.J_intrinsics.transpose();
    cov.diagonal().array() += sigma_floor_px * sigma_floor_px;
    return at.residual_px.dot(cov.ldlt().solve(at.residual_px));
  }
};

/// Typical miss in predicted sigmas; reorders the squares.
double typical(std::span<double> squares) {
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return std::sqrt(*middle / kMedianOfSquare);
}

/// Squared misses of all held-out rings, and the camera that misses most. @return how many were written.
std::size_t predict(const Session& session, const rig::RigSolution& kept, std::span<double> misses, Outcome& outcome) {
  std::size_t count = 0;
  double worst = -1;
  for (std::size_t i = 0; i < outcome.cameras.size(); ++i) {
    const CameraOutcome& camera = outcome.cameras[i];
    if (!camera.located) continue;
    const std::size_t first = count;
    const Predictor predictor(session, kept, i, camera.view);
    for (const rig::RingObservation& ring : camera.rings.subspan(camera.kept_rings)) {
      const double miss = predictor.squared_miss(ring, outcome.landmarks[ring.landmark]);
      if (miss >= 0) misses[count++] = miss;
    }
    const double own = count > first ? typical(misses.subspan(first, count - first)) : -1;
    if (own > worst) outcome.held_out.worst_camera = camera.name;
    worst = std::max(worst, own);
  }
  return count;
}

std::size_t count_held_out(const Outcome& outcome) {
  std::size_t count = 0;
  for (const CameraOutcome& camera : outcome.cameras)
    if (camera.located) count += camera.rings.size() - camera.kept_rings;
  return count;
}

}  // namespace

void hold_out_last(CameraOutcome& camera) {
  const auto kept = [](const rig::RingObservation& ring) { return !is_held_out(ring); };
  const auto middle = std::partition(camera.rings.begin(), camera.rings.end(), kept);
  camera.kept_rings = static_cast<std::size_t>(middle - camera.rings.begin());
  if (camera.kept_rings < kMinKept) camera.kept_rings = camera.rings.size();
}

Status predict_held_out(const Session& session, Arenas& arenas, Outcome& outcome) {
  outcome.held_out = {};
  const std::size_t held_out = count_held_out(outcome);
  if (held_out == 0) return ok_status();
  const Arena::Scope scope(arenas.step);
  JointProblemInput joint;
  number_sensors(session, outcome, joint);
  for (const CameraOutcome& camera : outcome.cameras)
    if (camera.located) joint.cameras[camera.view].observations = camera.rings.first(camera.kept_rings);
  rig::RigSolution kept;
  const Status status = rig::solve_rig(joint.input(outcome), solve_options(session), arenas.step, arenas.scratch, kept);
  if (status.code() == StatusCode::kOutOfMemory) return status;
  if (!status.ok()) return ok_status();  // four fifths do not determine what all do: the covariance says so already
  const std::span<double> misses = arenas.step.allocate<double>(held_out);
  if (misses.empty()) return out_of_arena("step arena: no room for held-out markers: reserve plan_memory()");
  outcome.held_out.markers = predict(session, kept, misses, outcome);
  if (outcome.held_out.markers > 0) outcome.held_out.median_sigmas = typical(misses.first(outcome.held_out.markers));
  return ok_status();
}

}  // namespace roomcal::calib
