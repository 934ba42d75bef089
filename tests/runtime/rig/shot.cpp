#include "tests/runtime/rig/shot.h"

namespace roomcal::rig::test {

namespace {

SE3 disturbed(truth::Random& random, const SE3& T_room_cam, const ShotOptions& options) {
  Vec6 xi = random.normals<6>();
  xi.head<3>() *= options.start_sigma_m;
  xi.tail<3>() *= options.start_sigma_rad;
  return T_room_cam * se3_exp(xi);
}

std::vector<RingObservation> observe(truth::Random& random, const std::vector<truth::RoomMarker>& room,
                                     const camera::Camera& camera, const SE3& T_room_cam, const ShotOptions& options,
                                     std::size_t& outliers) {
  std::vector<RingObservation> observations;
  std::vector<truth::Sighting> sightings = truth::see_markers(room, camera, T_room_cam);
  while (sightings.size() > options.max_observations)
    sightings.erase(sightings.begin() + static_cast<std::ptrdiff_t>(random.index(sightings.size())));
  for (const truth::Sighting& sighting : sightings) {
    const Mat22 cov_px2 = truth::random_cov_px2(random, options.min_sigma_px, options.max_sigma_px);
    Vec2 centre_px = sighting.centre_px;
    if (options.draw_noise) centre_px += truth::draw(random, cov_px2);
    if (random.uniform() < options.outlier_fraction) {
      const double angle_rad = random.uniform(0, 2 * kPi);
      centre_px += random.uniform(5, 50) * Vec2(std::cos(angle_rad), std::sin(angle_rad));
      ++outliers;
    }
    observations.push_back({centre_px, cov_px2, sighting.marker});
  }
  return observations;
}

/// A lens as its own calibration left it.
void draw_lens(truth::Random& random, const camera::Camera& truth, const ShotOptions& options, Shot& shot) {
  const camera::Parameters sigma = camera::parameter_sigmas(truth, options.intrinsics_sigma);
  camera::Intrinsics given = truth.intrinsics();
  if (!sigma.isZero(0)) {
    const camera::Parameters off = sigma.cwiseProduct(random.normals<camera::kIntrinsicsCount>());
    given = camera::with_parameters(given, camera::parameters_of(given) + off);
  }
  shot.given.push_back(camera::Camera::create(given).value());
  shot.intrinsics_sigma.push_back(sigma);
}

}  // namespace

std::vector<CameraView> Shot::views() const {
  std::vector<CameraView> views;
  for (std::size_t i = 0; i < device.size(); ++i)
    views.push_back({&given[i], observations[i], start_T_room_cam[i], intrinsics_sigma[i]});
  return views;
}

std::size_t Shot::observation_count() const {
  std::size_t count = 0;
  for (const auto& list : observations) count += list.size();
  return count;
}

Shot make_shot(truth::Random& random, const std::vector<truth::RoomMarker>& room, const ShotOptions& options) {
  Shot shot;
  shot.device = truth::make_device(random, options.cameras, options.lens);
  const SE3 T_room_rig = truth::random_T_room_rig(random);
  for (const truth::DeviceCamera& camera : shot.device) shot.T_room_cam.push_back(T_room_rig * camera.T_rig_cam);
  redraw(random, room, options, shot);
  return shot;
}

void redraw(truth::Random& random, const std::vector<truth::RoomMarker>& room, const ShotOptions& options, Shot& shot) {
  shot.landmarks.clear();
  shot.observations.clear();
  shot.start_T_room_cam.clear();
  shot.given.clear();
  shot.intrinsics_sigma.clear();
  shot.outliers = 0;
  for (const truth::RoomMarker& marker : room) {
    Vec3 p_room = marker.p_room;
    if (!options.map_cov_m2.isZero(0)) p_room += truth::draw(random, options.map_cov_m2);
    shot.landmarks.push_back({p_room, options.map_cov_m2});
  }
  for (std::size_t i = 0; i < shot.device.size(); ++i) {
    const SE3& T_room_cam = shot.T_room_cam[i];
    shot.start_T_room_cam.push_back(disturbed(random, T_room_cam, options));
    draw_lens(random, shot.device[i].camera, options, shot);
    shot.observations.push_back(observe(random, room, shot.device[i].camera, T_room_cam, options, shot.outliers));
  }
}

Status Solver::solve(const Shot& shot, const SolveOptions& options) {
  return solve(shot.views(), shot.landmarks, options);
}

Status Solver::solve(std::span<const CameraView> views, std::span<const Landmark> landmarks,
                     const SolveOptions& options) {
  Arena step(step_bytes_), scratch(scratch_bytes_);
  Eigen::internal::set_is_malloc_allowed(false);  // asserts in Debug builds
  const Status status = solve_cameras(views, landmarks, options, step, scratch, solution, &degenerate_view);
  Eigen::internal::set_is_malloc_allowed(true);
  return status;
}

}  // namespace roomcal::rig::test
