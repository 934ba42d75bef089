#include "runtime/export/summary.h"

#include <cmath>

#include "runtime/export/frames.h"

namespace roomcal::exports {

namespace {

constexpr double kChi2_6dof_999 = 22.458;  // 99.9 % of the chi-square distribution with 6 degrees of freedom

double sigma(const Mat66& cov, int first) { return std::sqrt(cov.diagonal().segment<3>(first).maxCoeff()); }

void write_sensor(const store::SensorRecord& sensor, TextWriter& out) {
  const Vec3 rpy = roll_pitch_yaw(sensor.T_rig_sensor.R);
  out.text("  ").padded(sensor.name.view(), 12).text(" x y z mm ");
  for (int i = 0; i < 3; ++i) out.fixed(1e3 * sensor.T_rig_sensor.t[i], 2).text(" ");
  out.text(" roll pitch yaw deg ");
  for (int i = 0; i < 3; ++i) out.fixed(rad_to_deg(rpy[i]), 3).text(" ");
  out.text(" sigma ").fixed(1e3 * sigma(sensor.cov_rig_sensor, 0), 3).text(" mm ");
  out.fixed(rad_to_deg(sigma(sensor.cov_rig_sensor, 3)), 4).text(" deg  inliers ");
  out.unsigned_integer(sensor.evidence.inliers).text("/").unsigned_integer(sensor.evidence.detections).text("\n");
}

void write_sensor(const store::SensorDiff& sensor, TextWriter& out) {
  out.text("  ").padded(sensor.name.view(), 12);
  if (!sensor.in_a || !sensor.in_b) {
    out.text(sensor.in_a ? " only in the first\n" : " only in the second\n");
    return;
  }
  out.text(" moved ")
      .fixed(1e3 * sensor.distance_m, 3)
      .text(" mm ")
      .fixed(rad_to_deg(sensor.angle_rad), 4)
      .text(" deg");
  if (sensor.has_chi2)
    out.text("  chi2 ")
        .fixed(sensor.chi2, 1)
        .text(sensor.chi2 > kChi2_6dof_999 ? " of 6: beyond chance" : " of 6: within its sigmas");
  out.text("\n");
}

}  // namespace

void write_summary(const store::Record& record, TextWriter& out) {
  write_origin(record, out);
  out.text("\n  ")
      .text(to_string(record.action))
      .text(", content of generation ")
      .unsigned_integer(record.content_generation);
  out.text(", device ").text(record.device_serial.view()).text(", map ").text(record.map_id.view()).text(", firmware ");
  out.text(record.firmware_id.view());
  if (!record.trigger.empty()) out.text(", trigger ").text(record.trigger.view());
  if (!std::isnan(record.temperature_c)) out.text(", ").fixed(record.temperature_c, 1).text(" degC");
  out.text("\n");
  for (const Reason& reason : record.reasons) out.text("  ").text(reason.view()).text("\n");
  for (const store::SensorRecord& sensor : record.sensors) write_sensor(sensor, out);
}

void write_summary(const store::RecordDiff& diff, TextWriter& out) {
  if (!diff.same_reference) out.text("  the records have different reference sensors: their poses do not compare\n");
  if (!diff.same_map) out.text("  the records were made in different maps\n");
  for (const store::SensorDiff& sensor : diff.sensors) write_sensor(sensor, out);
}

}  // namespace roomcal::exports
