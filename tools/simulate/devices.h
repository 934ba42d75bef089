#pragma once

#include <string>
#include <vector>

#include "runtime/camera/intrinsics.h"
#include "runtime/math/se3.h"

namespace roomcal::tools {

struct DeviceCamera {
  std::string name;
  camera::Intrinsics nominal;
};

/// A terrestrial scanner, a profiler that a servo turns over the whole sphere: a cloud instead of packets.
inline constexpr const char* kTlsKind = "tls";

struct DeviceLidar {
  std::string name;
  std::string unit;  ///< one of lidar_unit_names(), or kTlsKind
};

/// Mounting by the drawing, as the paper tabulates it: p_to = R p_from + t, R = Rz(c) Ry(b) Rx(a).
struct MountingEdge {
  std::string to;
  std::string from;
  Vec3 euler_xyz_deg = Vec3::Zero();
  Vec3 t_m = Vec3::Zero();

  SE3 T_to_from() const;
};

/// One of the paper's devices.
struct PaperDevice {
  std::string name;
  std::vector<DeviceCamera> cameras;  ///< the first is the reference
  std::vector<DeviceLidar> lidars;
  std::vector<MountingEdge> edges;  ///< each sensor but the first is the `to` of one edge: cameras, then LiDARs
  double height_m = 1;              ///< of the reference camera
  double pitch_deg = 0;             ///< of the reference camera, upwards positive
  bool looks_across = false;        ///< a narrow field of view: stands near a wall and looks along the room
};

/// stereo_rig, mobile_robot, backpack, tls; nominal extrinsics: Fang et al. 2021, tables II to V; lenses: typical.
const std::vector<PaperDevice>& known_devices();

/// "stereo_rig, mobile_robot, ..."
std::string device_names();

/// @throws ToolError that lists the names.
const PaperDevice& device_named(const std::string& name);

/// The same device with other spinning LiDARs. @param unit  one of lidar_unit_names(); empty: as it is
/// @throws ToolError if the device has none.
PaperDevice with_lidars(PaperDevice device, const std::string& unit);

/// The same device with cameras of another resolution and the same field of view. @param scale  above 0
PaperDevice scaled(PaperDevice device, double scale);

}  // namespace roomcal::tools
