#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/calib/limits.h"
#include "runtime/camera/parameters.h"
#include "runtime/lidar/turntable.h"
#include "runtime/math/se3.h"
#include "runtime/profile/wiring.h"

namespace roomcal::tools {

enum class SensorKind { kCamera, kLidar };

/// Where the drawing says a sensor sits, and how far off it may be. Never a start value: only a check of the result.
struct NominalMount {
  SE3 T_rig_sensor;
  double sigma_t_m = 0;      ///< per axis
  double sigma_rot_rad = 0;  ///< per axis
};

struct Sensor {
  std::string name;
  SensorKind kind = SensorKind::kCamera;
  camera::Intrinsics intrinsics;  ///< of a camera
  double sigma_px = 0;            ///< of a camera: what its intrinsics leave, per axis; 0: exact
  std::optional<camera::IntrinsicsSigma> intrinsics_sigma;  ///< of a camera; else camera::usual_sigma()
  std::string lidar_model;                                  ///< of a LiDAR: "vlp16", "tls", ...
  std::string file;                                         ///< of a LiDAR: its file in a shot folder; may be empty
  std::optional<NominalMount> nominal;
  std::string serial;                   ///< off its label; may be empty
  std::string calibration_file;         ///< of a LiDAR: the unit's own angles, beside device.yaml; may be empty
  profile::CameraWiring camera_wiring;  ///< of a camera
  profile::LidarWiring lidar_wiring;    ///< of a LiDAR
  std::optional<lidar::TurntableMounting> turntable;  ///< of a profiler that a servo turns
};

/// What `device.yaml` says: the sensors of one rig, and which of them is the rig's frame.
struct Device {
  std::string name;
  std::string rig_frame;  ///< name of the reference sensor
  std::vector<Sensor> sensors;
  calib::Limits limits;  ///< of the verdict
  std::string serial;    ///< of the device; may be empty
  profile::GrabWiring grab;
  profile::Wiring wiring;

  /// @return nullptr if there is none of that name.
  const Sensor* find(const std::string& sensor) const;
};

/// @throws ToolError "<where>: ..." for what no reader or writer may let pass: no sensors, names that are empty, too
///         long, doubled or hold other characters than letters, digits, `_`, `-`, `.`; serials that a record has no
///         room for; an unknown rig frame; a nominal mount of the rig frame that is not the identity; intrinsics that
///         camera::Camera refuses.
void check_device(const Device& device, const std::string& where);

/// "pinhole_radtan" or "kannala_brandt".
std::string to_string(camera::Model model);

}  // namespace roomcal::tools
