#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/fixed_text.h"
#include "runtime/base/fixed_vector.h"
#include "runtime/base/status.h"
#include "runtime/calib/device.h"
#include "runtime/calib/limits.h"
#include "runtime/lidar/calibration.h"
#include "runtime/lidar/turntable.h"
#include "runtime/profile/wiring.h"
#include "runtime/store/record.h"

namespace roomcal::profile {

struct CameraProfile {
  SensorName name;
  store::Serial serial;
  camera::Intrinsics intrinsics;
  double sigma_px = 0;
  calib::NominalMounting nominal;
  CameraWiring wiring;
};

struct LidarProfile {
  SensorName name;
  store::Serial serial;
  SensorName model;
  lidar::Calibration calibration;  ///< the unit's angles, or the manual's
  calib::NominalMounting nominal;
  LidarWiring wiring;
  bool on_turntable = false;  ///< a 2-D profiler that the servo turns
  lidar::TurntableMounting turntable;
};

/// One device as it was provisioned: all that the program on it knows beside the room's map and its store. Plain
/// memory, some 60 kB.
struct Profile {
  store::LongId device;       ///< its name
  store::Serial serial;       ///< records of other devices are not used
  std::size_t reference = 0;  ///< number of the camera whose frame is the rig's
  FixedVector<CameraProfile, calib::kMaxCameras> cameras;
  FixedVector<LidarProfile, calib::kMaxLidars> lidars;
  calib::Limits limits;
  GrabWiring grab;
  Wiring wiring;
};

/// Reads what `roomcal provision` made. Total: any bytes give a profile or a status.
///
/// @param bytes  aligned to 8; may be longer than the profile.
/// @param[out] profile  overwritten; means something only for kOk.
/// @param[out] what  what is wrong and the remedy; empty for kOk.
/// @return kOk; kCorrupt (damaged, cut, or values that check_profile() refuses); kUnsupported (another version, a LiDAR
///         model or a limit that this firmware does not know); kInvalidArgument if the bytes are not aligned.
/// Cost: linear in the size; no heap.
Status decode_profile(std::span<const std::byte> bytes, Profile& profile, Reason& what);

/// Whether a device can work as a profile says, whoever made it: names and serials printable and used once, at least
/// one camera and the reference among them, intrinsics that a camera can have, angles for every LiDAR, mountings,
/// limits and times in their ranges, what each chosen driver needs, and no two drivers that would take each other's
/// data.
/// @param[out] what  the first thing that cannot work, by name and with the remedy; empty for kOk.
/// @return kOk or kInvalidArgument. Cost: microseconds; no heap.
Status check_profile(const Profile& profile, Reason& what);

/// The sensors as the session wants them, in the profile's order.
/// @param[out] device  overwritten; means something only for kOk.
/// @return kOk; kInvalidArgument for intrinsics or a LiDAR model that are none: a profile that was checked has neither.
Status to_device(const Profile& profile, calib::Device& device);

}  // namespace roomcal::profile
