#pragma once

#include <filesystem>
#include <string>

#include "runtime/lidar/calibration.h"

namespace roomcal::tools {

/// A unit's file as its maker or the usual drivers write it. `name` is for messages; all @throws ToolError naming file,
/// line where there is one, and what to mend.

/// Hesai: CSV `Channel|Laser id,Elevation,Azimuth` in degrees, channels from 1.
lidar::Calibration parse_hesai_csv(lidar::Model model, const std::string& name, const std::string& text);

/// RoboSense: CSV `elevation,azimuth` in degrees, one line a laser, no head.
lidar::Calibration parse_robosense_csv(const std::string& name, const std::string& text);

/// Velodyne: the ROS drivers' YAML (`lasers: [{laser_id, rot_correction, vert_correction, ...}]`, rad and m).
lidar::Calibration parse_velodyne_yaml(lidar::Model model, const std::string& name, const std::string& text);

/// Ouster: metadata JSON, flat (firmware 2) or nested (firmware 3).
lidar::Calibration parse_ouster_json(const std::string& name, const std::string& text);

/// Reads the file of whichever kind the model wants. An empty path: the manual's angles, where the model has any.
/// @throws ToolError also if the model needs its unit's file and none is given.
lidar::Calibration read_calibration(lidar::Model model, const std::filesystem::path& path);

}  // namespace roomcal::tools
