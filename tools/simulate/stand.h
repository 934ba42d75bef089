#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "runtime/camera/camera.h"
#include "runtime/math/se3.h"
#include "tools/simulate/devices.h"
#include "tools/simulate/imu.h"
#include "tools/simulate/scene.h"
#include "tools/simulate/shot_options.h"

namespace roomcal::tools {

/// One camera of the device as it truly is.
struct TrueCamera {
  std::string name;
  camera::Camera camera;
  SE3 T_room_cam;
};

/// One LiDAR of the device as it truly is.
struct TrueLidar {
  std::string name;
  std::string unit;  ///< as in DeviceLidar
  std::string kind;  ///< as in device.yaml
  uint64_t unit_seed = 0;
  SE3 T_room_lidar = {};
  double sigma_m = 0;
  std::vector<double> beam_offset_m = {};  ///< measured = true + offset; one for each laser
};

/// What the truth file says of how an edge was mounted: T_to_from = [exp(rotvec) R_nominal | t_nominal + dt].
struct Perturbation {
  Vec3 rotvec_rad = Vec3::Zero();
  Vec3 dt_m = Vec3::Zero();
};

/// A device standing in a room.
struct Stand {
  const PaperDevice* device = nullptr;
  std::vector<TrueCamera> cameras;
  std::vector<TrueLidar> lidars;
  std::optional<TrueImu> imu;
  std::vector<Perturbation> perturbations;  ///< one per edge of the device
};

/// Name and T_room_sensor of every sensor: cameras, then LiDARs.
std::vector<std::pair<std::string, SE3>> sensor_poses(const Stand& stand);

/// Draws the device's true lenses, beam offsets, mounting and place. The same seed gives the same stand.
/// @param device  must outlive the stand.
Stand place_device(const Scene& scene, const PaperDevice& device, const ShotOptions& options);

}  // namespace roomcal::tools
