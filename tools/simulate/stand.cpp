#include "tools/simulate/stand.h"

#include <cmath>
#include <memory>

#include <Eigen/Geometry>

#include "tools/common/error.h"
#include "tools/simulate/lidar_unit.h"
#include "tools/simulate/random_stream.h"
#include "tools/simulate/stand_place.h"

namespace roomcal::tools {

namespace {

constexpr double kTlsSigma_m = 0.005;

Vec3 normal3(Random& random) { return {random.normal(), random.normal(), random.normal()}; }

/// A lens of the series: focal length to half a percent, principal point to a percent of the width.
camera::Camera draw_lens(const camera::Intrinsics& nominal, Random& random) {
  camera::Intrinsics lens = nominal;
  const double focal = 1 + 0.004 * random.normal();
  lens.fx_px *= focal;
  lens.fy_px *= focal * (1 + 3e-4 * random.normal());
  lens.cx_px += 0.008 * nominal.width_px * random.normal();
  lens.cy_px += 0.008 * nominal.width_px * random.normal();
  for (double& coefficient : lens.distortion) coefficient *= 1 + 0.1 * random.normal();
  auto made = camera::Camera::create(lens);
  require(made.status(), "simulated lens");
  return made.value();
}

TrueLidar draw_lidar(const DeviceLidar& lidar, const LidarOptions& options, Random& random) {
  TrueLidar drawn{.name = lidar.name, .unit = lidar.unit, .kind = kTlsKind};
  if (lidar.unit == kTlsKind) {
    drawn.sigma_m = options.sigma_m.value_or(kTlsSigma_m);
    drawn.beam_offset_m = {0};  // a scanner of one beam is calibrated by its maker
    return drawn;
  }
  drawn.unit_seed = random.bits();
  const std::unique_ptr<LidarUnit> unit = make_lidar_unit(lidar.unit, drawn.unit_seed, 0);
  drawn.kind = unit->model();
  drawn.sigma_m = options.sigma_m.value_or(unit->spread().sigma_m);
  const double bias_sigma_m = options.bias_sigma_m.value_or(unit->spread().bias_sigma_m);
  for (std::size_t beam = 0; beam < unit->beams(); ++beam)
    drawn.beam_offset_m.push_back(bias_sigma_m * random.normal());
  return drawn;
}

SE3& pose_of(Stand& stand, const std::string& sensor) {
  for (TrueCamera& camera : stand.cameras)
    if (camera.name == sensor) return camera.T_room_cam;
  for (TrueLidar& lidar : stand.lidars)
    if (lidar.name == sensor) return lidar.T_room_lidar;
  throw ToolError("device: no sensor " + sensor);
}

Perturbation draw_perturbation(const ShotOptions& options, Random& random) {
  return {deg_to_rad(options.sigma_rot_deg) * normal3(random), options.sigma_t_m * normal3(random)};
}

SE3 T_from_to(const MountingEdge& edge, const Perturbation& drawn) {
  const SE3 nominal = edge.T_to_from();
  return SE3{so3_exp(drawn.rotvec_rad) * nominal.R, nominal.t + drawn.dt_m}.inverse();
}

}  // namespace

std::vector<std::pair<std::string, SE3>> sensor_poses(const Stand& stand) {
  std::vector<std::pair<std::string, SE3>> poses;
  for (const TrueCamera& camera : stand.cameras) poses.emplace_back(camera.name, camera.T_room_cam);
  for (const TrueLidar& lidar : stand.lidars) poses.emplace_back(lidar.name, lidar.T_room_lidar);
  return poses;
}

Stand place_device(const Scene& scene, const PaperDevice& device, const ShotOptions& options) {
  Random random = random_stream(options.seed, 1);
  Random lidar_random = random_stream(options.seed, 2);
  Stand stand{&device, {}, {}, {}, {}};
  for (const DeviceCamera& camera : device.cameras) {
    stand.cameras.push_back({camera.name, draw_lens(camera.nominal, random), {}});
  }
  stand.cameras.front().T_room_cam = draw_place(scene, device, random);
  for (const DeviceLidar& lidar : device.lidars) stand.lidars.push_back(draw_lidar(lidar, options.lidar, lidar_random));
  for (const MountingEdge& edge : device.edges) {
    stand.perturbations.push_back(draw_perturbation(options, random));
    pose_of(stand, edge.to) = pose_of(stand, edge.from) * T_from_to(edge, stand.perturbations.back());
  }
  if (options.imu) {
    Random imu_random = random_stream(options.seed, 3);
    const Perturbation drawn = draw_perturbation(options, imu_random);
    stand.imu = draw_imu(stand.cameras.front().T_room_cam * T_from_to(imu_mounting(), drawn), imu_random);
  }
  return stand;
}

}  // namespace roomcal::tools
