#pragma once

#include "runtime/base/text_writer.h"
#include "runtime/math/se3.h"
#include "runtime/store/record.h"

namespace roomcal::exports {

/// Axes as ROS wants them of a body (REP 103: x forward, y left, z up), in the axes that we use for the sensor: of a
/// camera (x right, y down, z forward) and of a Velodyne as in its manual (x right, y forward, z up). Other sensors
/// keep theirs.
SE3 T_sensor_body(const store::SensorRecord& sensor);

/// (roll, pitch, yaw) with R = Rz(yaw) Ry(pitch) Rx(roll), exact at pitch = +-90 degrees too.
Vec3 roll_pitch_yaw(const Mat33& R);

/// The same point in two frames.
struct WorkedPoint {
  const store::SensorRecord* sensor = nullptr;
  Vec3 p_sensor;
  Vec3 p_rig;
};
/// Of the last sensor that is not the reference; of the reference if it is alone.
WorkedPoint worked_point(const store::Record& record, bool cameras_only);

/// "x, y, z"
void write_triple(const Vec3& v, TextWriter& out, std::string_view separator = ", ");

/// Whence and when, for the top of a file: one comment line, without its comment sign and without a newline.
void write_origin(const store::Record& record, TextWriter& out);

}  // namespace roomcal::exports
