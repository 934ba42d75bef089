#pragma once

#include <cstddef>

#include "runtime/base/fixed_text.h"
#include "runtime/base/fixed_vector.h"
#include "runtime/camera/camera.h"
#include "runtime/camera/parameters.h"
#include "runtime/math/se3.h"
#include "runtime/rig/camera_rig.h"
#include "runtime/scan/sensor_model.h"
#include "runtime/store/record.h"

namespace roomcal::calib {

inline constexpr std::size_t kMaxCameras = 8;
inline constexpr std::size_t kMaxLidars = 4;
static_assert(kMaxCameras <= rig::kMaxViews && kMaxLidars <= rig::kMaxLidars);
inline constexpr std::size_t kMaxSensors = kMaxCameras + kMaxLidars;
/// Sweeps of one LiDAR that are joined; those beyond are left out and reported.
inline constexpr std::size_t kMaxSweeps = 32;
/// Markers kept per image. A room has some 340; what is beyond is reported, not dropped silently.
inline constexpr std::size_t kMaxDetections = 512;

/// How far a sensor may sit from its drawing.
struct NominalMounting {
  bool known = false;
  SE3 T_rig_sensor;
  double sigma_rot_rad = 0;  ///< per axis
  double sigma_t_m = 0;      ///< per axis
};

struct CameraSpec {
  SensorName name;
  camera::Camera camera;
  NominalMounting nominal;
  /// What the intrinsics leave, per axis: the reprojection error of their own calibration; 0: exact.
  double sigma_px = 0;
  /// How far off the intrinsics may be, where they are refined along.
  camera::IntrinsicsSigma intrinsics_sigma = {};
  store::Serial serial = {};  ///< for the record; may be empty
};

struct LidarSpec {
  SensorName name;
  SensorName model;  ///< "vlp16", ...: for the record
  scan::SensorModel ranges;
  NominalMounting nominal;
  store::Serial serial = {};  ///< for the record; may be empty
};

/// The device as provisioned. The rig frame is the frame of the reference camera.
struct Device {
  FixedVector<CameraSpec, kMaxCameras> cameras;
  std::size_t reference = 0;  ///< number of the reference camera
  FixedVector<LidarSpec, kMaxLidars> lidars;
  bool refine_intrinsics = false;  ///< of every camera along with the extrinsics, by its intrinsics_sigma

  /// Sigma of every parameter of a camera, as the joint solution takes it; zero if intrinsics are held.
  camera::Parameters intrinsics_sigma(std::size_t number) const {
    const CameraSpec& spec = cameras[number];
    return refine_intrinsics ? camera::parameter_sigmas(spec.camera, spec.intrinsics_sigma)
                             : camera::Parameters(camera::Parameters::Zero());
  }
};

}  // namespace roomcal::calib
