#pragma once

#include <filesystem>
#include <string>

#include "tools/device/device.h"

namespace roomcal::tools {

/// `device.yaml`, which people write and `roomcal import` makes:
///
///     version: 1
///     name: robot
///     rig_frame: cam0                  # the reference sensor: T_rig_<it> is the identity
///     sensors:
///       - name: cam0
///         kind: camera
///         model: kannala_brandt        # or pinhole_radtan
///         resolution_px: [1280, 720]   # width, height
///         intrinsics_px: [612.2, 612.4, 634.9, 362.0]   # fx fy cx cy; (0, 0) is the centre of the top-left pixel
///         distortion: [-0.019, 0.0045, -0.0018, 0.0003] # k1 k2 k3 k4, or k1 k2 p1 p2
///         sigma_px: 0.1                # what these leave of a ring's place, per axis; may be left out: exact
///         intrinsics_sigma:            # how far off they may be, for --refine-intrinsics; may be left out:
///           focal_px: 1.2              #   0.2 % of the focal length,
///           principal_px: 1            #   1 px,
///           distortion_px: 0.5         #   0.5 px in the image's corner for each coefficient; 0: held
///       - name: lidar0
///         kind: lidar
///         model: vlp16
///         file: lidar0.pcap            # in a shot folder; may be left out
///         nominal:                     # of any sensor but the rig frame; may be left out
///           T_rig_sensor:              # maps points of the sensor to the rig frame, metres
///             - [1, 0, 0, 0.10]
///             - [0, 1, 0, 0]
///             - [0, 0, 1, 0]
///             - [0, 0, 0, 1]
///           sigma_t_m: 0.008           # how far off the mounting may be, per axis
///           sigma_rot_deg: 1
///     serial: RB-0042                  # of the device; may be left out, and so may a sensor's
///     limits:                          # of the verdict; may be left out, and so may each of them (limits_yaml.h)
///       max_sigma_t_m: 0.003
///
/// `turntable: {axis_lidar: [x, y, z], T_lidar_profiler: rows}` makes a 2-D profiler that a servo turns a LiDAR (model
/// tls; see lidar::TurntableMounting). `driver` of a sensor, `calibration` of a LiDAR (the unit's angles, a file beside
/// this one), `grab` and `wiring` say how the device is put together: wiring_yaml.h. They are what `roomcal provision`
/// puts on the device; the host's commands need none of them.
///
/// Strict: a key that is not above is an error, because a mistyped one would be ignored silently.
/// @param where  the file's name, for messages.
/// @throws ToolError "where:line: ..." naming what is wrong and the remedy.
Device parse_device_yaml(const std::string& where, const std::string& text);

/// The same text back; numbers with all their digits, so that reading it gives the same device.
std::string to_device_yaml(const Device& device);

/// @throws ToolError as above, or if the file cannot be read.
Device read_device(const std::filesystem::path& path);

}  // namespace roomcal::tools
