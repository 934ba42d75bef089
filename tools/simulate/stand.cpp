#include "tools/simulate/stand.h"

#include <cmath>
#include <memory>

#include <Eigen/Geometry>

#include "tools/common/error.h"
#include "tools/simulate/lidar_unit.h"
#include "tools/simulate/planar.h"
#include "tools/simulate/random_stream.h"

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

/// Camera axes x right, y down, z forward, looking along `yaw` with the horizon level, then pitched and rolled.
Mat33 upright(double yaw_rad, double pitch_rad, double roll_rad) {
  Mat33 R_room_level;
  R_room_level.col(2) = Vec3(std::cos(yaw_rad), std::sin(yaw_rad), 0);
  R_room_level.col(1) = -Vec3::UnitZ();
  R_room_level.col(0) = R_room_level.col(1).cross(R_room_level.col(2));
  return R_room_level * so3_exp(pitch_rad * Vec3::UnitX()) * so3_exp(roll_rad * Vec3::UnitZ());
}

bool stands_free(const Scene& scene, const Vec3& place) {
  constexpr double kBodyOfDevice_m = 0.35;
  for (const Body& body : scene.bodies) {
    if (clearance(body, place) < kBodyOfDevice_m) return false;
  }
  return true;
}

/// In the middle part of the room; a narrow camera near one of its ends, looking across.
SE3 draw_place(const Scene& scene, const PaperDevice& device, Random& random) {
  constexpr int kTries = 1000;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const Vec2 share = device.looks_across ? Vec2(random.uniform(0.12, 0.3), random.uniform(0.12, 0.3))
                                           : Vec2(random.uniform(0.35, 0.65), random.uniform(0.35, 0.65));
    Vec2 corner(random.uniform() < 0.5 ? 1 : 0, random.uniform() < 0.5 ? 1 : 0);
    if (!device.looks_across) corner.setZero();
    const Vec2 at = (corner - share).cwiseAbs().cwiseProduct(scene.size.head<2>());
    const Vec3 place(at.x(), at.y(), device.height_m + random.uniform(-0.1, 0.1));
    const Vec2 to_middle = scene.size.head<2>() / 2 - at;
    const double yaw = device.looks_across ? std::atan2(to_middle.y(), to_middle.x()) + random.uniform(-0.2, 0.2)
                                           : random.uniform(-kPi, kPi);
    const double pitch = deg_to_rad(device.pitch_deg + random.uniform(-3, 3));
    const double roll = deg_to_rad(random.uniform(-3, 3));
    if (stands_free(scene, place)) return {upright(yaw, pitch, roll), place};
  }
  throw ToolError("simulate shot: no free place for the device; make the room larger or emptier");
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
  Stand stand{&device, {}, {}, {}};
  for (const DeviceCamera& camera : device.cameras) {
    stand.cameras.push_back({camera.name, draw_lens(camera.nominal, random), {}});
  }
  stand.cameras.front().T_room_cam = draw_place(scene, device, random);
  for (const DeviceLidar& lidar : device.lidars) stand.lidars.push_back(draw_lidar(lidar, options.lidar, lidar_random));
  for (const MountingEdge& edge : device.edges) {
    const Perturbation drawn{deg_to_rad(options.sigma_rot_deg) * normal3(random), options.sigma_t_m * normal3(random)};
    const SE3 nominal = edge.T_to_from();
    const SE3 T_to_from{so3_exp(drawn.rotvec_rad) * nominal.R, nominal.t + drawn.dt_m};
    pose_of(stand, edge.to) = pose_of(stand, edge.from) * T_to_from.inverse();
    stand.perturbations.push_back(drawn);
  }
  return stand;
}

}  // namespace roomcal::tools
