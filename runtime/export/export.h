#pragma once

#include <string_view>

#include "runtime/base/status.h"
#include "runtime/base/text_writer.h"
#include "runtime/store/record.h"

namespace roomcal::exports {

/// Files that other software reads. What each means by its numbers is said in a comment at its top, and each carries
/// one worked point: the same point in two frames, so that a reader can prove his understanding of it.
enum class Format : uint8_t {
  kJson,      ///< everything that the record says
  kKalibr,    ///< camchain.yaml: cameras, chained T_cn_cnm1
  kUrdf,      ///< ROS: one fixed joint per sensor
  kRosTf,     ///< ROS 2 launch file of static_transform_publisher, quaternions
  kRosInfo,   ///< ROS camera_info YAML of one camera
  kAutoware,  ///< sensor_kit_calibration.yaml
  kOpenCv,    ///< cv::FileStorage YAML, keys as MC-Calib's
};

/// "json", "kalibr", "urdf", "tf", "camera_info", "autoware", "opencv".
const char* to_string(Format format);
/// @return kNotFound for any other name, listing them.
Result<Format> parse_format(std::string_view name);

/// @param record  passes store::check_record().
/// @param camera  name of the camera for kRosInfo, otherwise ignored.
/// @param[out] out  appended to; holds a part when kCapacity.
/// @return kNotFound if kRosInfo names no camera of the record, or kKalibr and kOpenCv find none in it;
///         kCapacity if `out` is too small: twelve sensors take up to 24 KiB.
/// Cost: linear in the sensors; no heap.
Status write(const store::Record& record, Format format, std::string_view camera, TextWriter& out);

}  // namespace roomcal::exports
