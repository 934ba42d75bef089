#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "runtime/base/names.h"
#include "runtime/store/record.h"

namespace roomcal::store {

namespace {

constexpr double kOrthonormalTolerance = 1e-6;
constexpr double kMaxTranslation_m = 1e3;    // a rig is smaller than a kilometre; beyond it, something else was written
constexpr double kMaxVariance = 1e6;         // m^2, rad^2
constexpr double kPsdTolerance = 1e-5;       // of the largest eigenvalue: rounding of the stored floats, with room
constexpr double kSameAsReference_m = 1e-9;  // two sensors never share an origin and axes this well

constexpr Status corrupt(const char* detail) { return {StatusCode::kCorrupt, detail}; }

bool is_transform(const SE3& T) {
  return T.R.allFinite() && T.t.allFinite() && T.t.cwiseAbs().maxCoeff() <= kMaxTranslation_m &&
         (T.R * T.R.transpose() - Mat33::Identity()).cwiseAbs().maxCoeff() <= kOrthonormalTolerance &&
         T.R.determinant() > 0;
}

bool is_identity(const SE3& T) {
  return T.t.norm() <= kSameAsReference_m && (T.R - Mat33::Identity()).cwiseAbs().maxCoeff() <= kSameAsReference_m;
}

bool is_covariance(const Mat66& cov) {
  if (!cov.allFinite() || cov.cwiseAbs().maxCoeff() > kMaxVariance || cov != cov.transpose()) return false;
  const Eigen::SelfAdjointEigenSolver<Mat66> solver(cov, Eigen::EigenvaluesOnly);
  return solver.info() == Eigen::Success && solver.eigenvalues()[0] >= -kPsdTolerance * solver.eigenvalues()[5];
}

bool is_intrinsics(const camera::Intrinsics& k) {
  const bool finite = std::isfinite(k.fx_px) && std::isfinite(k.fy_px) && std::isfinite(k.cx_px) &&
                      std::isfinite(k.cy_px) &&
                      std::all_of(k.distortion.begin(), k.distortion.end(), [](double d) { return std::isfinite(d); });
  return finite && k.fx_px > 0 && k.fy_px > 0 && k.width_px > 0 && k.height_px > 0 &&
         (k.model == camera::Model::kPinholeRadtan || k.model == camera::Model::kKannalaBrandt);
}

Status check_sensor(const SensorRecord& sensor, bool is_reference) {
  if (!is_name(sensor.name.view())) return corrupt("a sensor's name is empty or not of letters, digits, _ - .");
  if (!is_printable(sensor.model.view()) || !is_printable(sensor.serial.view()))
    return corrupt("a sensor's model or serial is not printable");
  if (sensor.kind != SensorKind::kCamera && sensor.kind != SensorKind::kLidar)
    return corrupt("a sensor of unknown kind");
  if (!is_transform(sensor.T_rig_sensor)) return corrupt("a sensor's T_rig_sensor is not a rigid transform");
  if (!is_covariance(sensor.cov_rig_sensor)) return corrupt("a sensor's covariance is not positive semi-definite");
  if (sensor.kind == SensorKind::kCamera && !is_intrinsics(sensor.intrinsics))
    return corrupt("a camera's intrinsics are not valid");
  const Evidence& e = sensor.evidence;
  if (!std::isfinite(e.rms) || !std::isfinite(e.coverage) || !std::isfinite(e.log_likelihood_gap))
    return corrupt("a sensor's evidence is not finite");
  if (is_reference != is_identity(sensor.T_rig_sensor))
    return corrupt(is_reference ? "the reference sensor is not at the identity"
                                : "a sensor sits exactly on the reference: that is no measurement");
  if (is_reference && sensor.cov_rig_sensor != Mat66::Zero()) return corrupt("the reference sensor has a covariance");
  return ok_status();
}

bool is_stamped(const Record& record) {
  const bool verdict_known = record.verdict <= Verdict::kFailService;
  const bool action_known = record.action <= Action::kFactoryRestored;
  return verdict_known && action_known && std::isfinite(record.chi2) && !std::isinf(record.temperature_c) &&
         record.content_generation <= record.generation;
}

}  // namespace

Status check_record(const Record& record) {
  if (!is_stamped(record)) return corrupt("the record's verdict, action, generation or figures are not valid");
  for (const Reason& reason : record.reasons)
    if (!is_printable(reason.view())) return corrupt("a reason is not printable");
  if (!is_printable(record.map_id.view()) || !is_printable(record.firmware_id.view()) ||
      !is_printable(record.device_serial.view()) || !is_printable(record.trigger.view()))
    return corrupt("an identifier is not printable");
  if (record.sensors.empty()) return corrupt("the record holds no sensor");
  if (record.reference >= record.sensors.size()) return corrupt("the record's reference is not one of its sensors");
  for (std::size_t i = 0; i < record.sensors.size(); ++i) {
    ROOMCAL_TRY(check_sensor(record.sensors[i], i == record.reference));
    if (record.find(record.sensors[i].name.view()) != &record.sensors[i])
      return corrupt("two sensors of the same name");
  }
  return ok_status();
}

}  // namespace roomcal::store
