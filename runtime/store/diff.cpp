#include "runtime/store/diff.h"

#include <Eigen/Cholesky>

namespace roomcal::store {

namespace {

SensorDiff compare(const SensorRecord& a, const SensorRecord& b) {
  SensorDiff out;
  out.name = a.name;
  out.in_a = out.in_b = true;
  const SE3 T_a_b = a.T_rig_sensor.inverse() * b.T_rig_sensor;
  out.xi = se3_log(T_a_b);
  out.distance_m = T_a_b.t.norm();
  out.angle_rad = rotation_angle_between(a.T_rig_sensor.R, b.T_rig_sensor.R);
  // Both covariances are right perturbations, so they are in the sensor's frame, which is the same to first order.
  const Eigen::LDLT<Mat66> sum(a.cov_rig_sensor + b.cov_rig_sensor);
  out.has_chi2 = sum.info() == Eigen::Success && sum.isPositive() && sum.vectorD().minCoeff() > 0;
  if (out.has_chi2) out.chi2 = out.xi.dot(sum.solve(out.xi));
  return out;
}

SensorDiff one_sided(const SensorRecord& sensor, bool in_a) {
  SensorDiff out;
  out.name = sensor.name;
  out.in_a = in_a;
  out.in_b = !in_a;
  return out;
}

}  // namespace

RecordDiff diff(const Record& a, const Record& b) {
  RecordDiff out;
  out.same_map = a.map_hash == b.map_hash && a.map_id.view() == b.map_id.view();
  out.same_reference = a.sensors[a.reference].name.view() == b.sensors[b.reference].name.view();
  for (const SensorRecord& sensor : a.sensors) {
    const SensorRecord* other = out.same_reference ? b.find(sensor.name.view()) : nullptr;
    static_cast<void>(out.sensors.push_back(other == nullptr ? one_sided(sensor, true) : compare(sensor, *other)));
  }
  for (const SensorRecord& sensor : b.sensors)
    if (!out.same_reference || a.find(sensor.name.view()) == nullptr)
      static_cast<void>(out.sensors.push_back(one_sided(sensor, false)));
  return out;
}

}  // namespace roomcal::store
