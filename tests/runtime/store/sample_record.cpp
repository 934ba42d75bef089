#include "tests/runtime/store/sample_record.h"

#include <string>

#include "tests/truth/random.h"

namespace roomcal::store::test {

namespace {

Mat66 sample_covariance(truth::Random& random) {
  Mat66 root;
  for (int i = 0; i < 36; ++i) root(i / 6, i % 6) = 1e-4 * random.normal();
  const Mat66 cov = root * root.transpose();
  return cov.cast<float>().cast<double>();  // what the format keeps of it
}

SensorRecord sample_sensor(truth::Random& random, std::string_view name, SensorKind kind, bool reference) {
  SensorRecord sensor;
  sensor.name = name;
  sensor.kind = kind;
  sensor.serial = "S-0042";
  if (kind == SensorKind::kCamera)
    sensor.intrinsics = {camera::Model::kPinholeRadtan, 1280, 800, 700.25 + random.normal(), 700.5, 640.125, 399.5,
                         {-0.25, 0.0625, 1e-4, -2e-4}};
  else
    sensor.model = "vlp16";
  if (!reference) {
    sensor.T_rig_sensor = se3_exp(random.normals<6>());
    sensor.cov_rig_sensor = sample_covariance(random);
  }
  sensor.evidence = {41, 39, 0.0625, 0.75, 120.5};
  return sensor;
}

bool same(const SensorRecord& a, const SensorRecord& b) {
  const camera::Intrinsics &k = a.intrinsics, &l = b.intrinsics;
  const Evidence &e = a.evidence, &f = b.evidence;
  return a.name.view() == b.name.view() && a.kind == b.kind && a.model.view() == b.model.view() &&
         a.serial.view() == b.serial.view() && a.T_rig_sensor.R == b.T_rig_sensor.R &&
         a.T_rig_sensor.t == b.T_rig_sensor.t && a.cov_rig_sensor == b.cov_rig_sensor && k.model == l.model &&
         k.width_px == l.width_px && k.height_px == l.height_px && k.fx_px == l.fx_px && k.fy_px == l.fy_px &&
         k.cx_px == l.cx_px && k.cy_px == l.cy_px && k.distortion == l.distortion && e.detections == f.detections &&
         e.inliers == f.inliers && e.rms == f.rms && e.coverage == f.coverage &&
         e.log_likelihood_gap == f.log_likelihood_gap;
}

}  // namespace

Record sample_record(uint64_t seed, std::size_t cameras, std::size_t lidars) {
  truth::Random random(seed);
  Record record;
  record.verdict = Verdict::kPassAdvise;
  static_cast<void>(record.reasons.push_back("cam1: 9 markers only"));
  record.map_id = "hall 3";
  record.map_hash = static_cast<uint32_t>(0xC0FFEE00U + seed);
  record.firmware_id = "roomcal 0.1.0";
  record.device_serial = "robot-7";
  record.measured_unix_s = 1'700'000'000 + static_cast<int64_t>(seed);
  record.temperature_c = 23.5;
  record.trigger = "line";
  record.chi2 = 300.5 + static_cast<double>(seed);
  record.degrees_of_freedom = 290;
  for (std::size_t i = 0; i < cameras; ++i)
    static_cast<void>(
        record.sensors.push_back(sample_sensor(random, "cam" + std::to_string(i), SensorKind::kCamera, i == 0)));
  for (std::size_t i = 0; i < lidars; ++i)
    static_cast<void>(record.sensors.push_back(
        sample_sensor(random, "lidar" + std::to_string(i), SensorKind::kLidar, cameras == 0 && i == 0)));
  return record;
}

Record largest_record() {
  Record record = sample_record(1, kMaxSensors);
  record.reasons.clear();
  while (record.reasons.push_back(std::string_view(std::string(200, 'r')))) continue;
  record.map_id = std::string_view(std::string(63, 'm'));
  record.firmware_id = std::string_view(std::string(63, 'f'));
  record.device_serial = std::string_view(std::string(31, 'd'));
  record.trigger = std::string_view(std::string(31, 't'));
  for (SensorRecord& sensor : record.sensors) {
    const std::string name(sensor.name.view());
    sensor.name = std::string_view(name + std::string(31 - name.size(), 'n'));
    sensor.model = std::string_view(std::string(31, 'm'));
    sensor.serial = std::string_view(std::string(31, 's'));
  }
  return record;
}

bool same_content(const Record& a, const Record& b) {
  bool alike = a.verdict == b.verdict && a.map_id.view() == b.map_id.view() && a.map_hash == b.map_hash &&
               a.firmware_id.view() == b.firmware_id.view() && a.device_serial.view() == b.device_serial.view() &&
               a.measured_unix_s == b.measured_unix_s && a.temperature_c == b.temperature_c &&
               a.trigger.view() == b.trigger.view() && a.chi2 == b.chi2 &&
               a.degrees_of_freedom == b.degrees_of_freedom && a.reference == b.reference &&
               a.reasons.size() == b.reasons.size() && a.sensors.size() == b.sensors.size();
  for (std::size_t i = 0; alike && i < a.reasons.size(); ++i) alike = a.reasons[i].view() == b.reasons[i].view();
  for (std::size_t i = 0; alike && i < a.sensors.size(); ++i) alike = same(a.sensors[i], b.sensors[i]);
  return alike;
}

bool same(const Record& a, const Record& b) {
  return a.generation == b.generation && a.content_generation == b.content_generation &&
         a.previous_content == b.previous_content && a.action == b.action && a.written_unix_s == b.written_unix_s &&
         same_content(a, b);
}

}  // namespace roomcal::store::test
