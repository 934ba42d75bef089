#include "runtime/camera/flat.h"
#include "runtime/store/record_codec.h"
#include "runtime/store/record_generated.h"

namespace roomcal::store {

namespace {

using camera::take_text;

constexpr Status corrupt(const char* detail) { return {StatusCode::kCorrupt, detail}; }

Mat66 to_covariance(const fbs::Covariance& stored) {
  Mat66 cov;
  flatbuffers::uoffset_t next = 0;
  for (int r = 0; r < 6; ++r)
    for (int c = r; c < 6; ++c) cov(r, c) = cov(c, r) = static_cast<double>(stored.upper()->Get(next++));
  return cov;
}

bool take(const fbs::Sensor& stored, SensorRecord& out) {
  if (!take_text(stored.name(), out.name) || !take_text(stored.model(), out.model) ||
      !take_text(stored.serial(), out.serial))
    return false;
  out.kind = static_cast<SensorKind>(stored.kind());
  out.T_rig_sensor = camera::to_se3(*stored.pose_rig());
  out.cov_rig_sensor = to_covariance(*stored.covariance());
  out.intrinsics = stored.intrinsics() == nullptr ? camera::Intrinsics{} : camera::to_intrinsics(*stored.intrinsics());
  const fbs::Evidence& e = *stored.evidence();
  out.evidence = {e.detections(), e.inliers(), static_cast<double>(e.rms()), static_cast<double>(e.coverage()),
                  static_cast<double>(e.log_likelihood_gap())};
  return true;
}

bool take_sensors(const fbs::Record& stored, Record& out) {
  out.sensors.clear();
  for (const fbs::Sensor* sensor : *stored.sensors())
    if (!out.sensors.push_back({}) || !take(*sensor, out.sensors.back())) return false;
  return true;
}

bool take_reasons(const fbs::Record& stored, Record& out) {
  out.reasons.clear();
  if (stored.reasons() == nullptr) return true;
  for (const flatbuffers::String* reason : *stored.reasons())
    if (!out.reasons.push_back({}) || !take_text(reason, out.reasons.back())) return false;
  return true;
}

void take_figures(const fbs::Record& stored, Record& out) {
  out.generation = stored.generation();
  out.content_generation = stored.content_generation();
  out.previous_content = stored.previous_content();
  out.action = static_cast<Action>(stored.action());
  out.verdict = static_cast<Verdict>(stored.verdict());
  out.map_hash = stored.map_hash();
  out.measured_unix_s = stored.measured_unix_s();
  out.written_unix_s = stored.written_unix_s();
  out.temperature_c = static_cast<double>(stored.temperature_c());
  out.chi2 = stored.chi2();
  out.degrees_of_freedom = stored.degrees_of_freedom();
  out.reference = stored.reference();
}

}  // namespace

Result<std::size_t> record_size(std::span<const std::byte> bytes) { return sealed_size(bytes, kRecordKind); }

Status decode_record(std::span<const std::byte> bytes, Record& record) {
  const Result<std::span<const std::byte>> opened = open_sealed(bytes, kRecordKind);
  ROOMCAL_TRY(opened.status());
  const std::span<const std::byte> payload = opened.value();
  flatbuffers::Verifier verifier(reinterpret_cast<const uint8_t*>(payload.data()), payload.size(), 8, 64);
  if (!fbs::VerifyRecordBuffer(verifier)) return corrupt("the record's structure is broken");
  const fbs::Record& stored = *fbs::GetRecord(payload.data());
  const bool fits = take_text(stored.map_id(), record.map_id) && take_text(stored.firmware_id(), record.firmware_id) &&
                    take_text(stored.device_serial(), record.device_serial) &&
                    take_text(stored.trigger(), record.trigger) && take_reasons(stored, record) &&
                    take_sensors(stored, record);
  if (!fits) return corrupt("the record holds more or longer entries than its version allows");
  take_figures(stored, record);
  return check_record(record);
}

}  // namespace roomcal::store
