#include <cstring>
#include <string_view>

#include "runtime/base/crc32c.h"
#include "runtime/store/record_codec.h"
#include "runtime/store/record_generated.h"

namespace roomcal::store {

namespace {

constexpr Status corrupt(const char* detail) { return {StatusCode::kCorrupt, detail}; }

template <std::size_t kCapacity>
bool take(const flatbuffers::String* text, FixedText<kCapacity>& out) {
  out.clear();
  if (text == nullptr) return true;
  if (text->size() > kCapacity) return false;
  out.append({text->c_str(), text->size()});
  return true;
}

SE3 to_se3(const fbs::Transform& stored) {
  SE3 T;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) T.R(r, c) = stored.rotation()->Get(static_cast<flatbuffers::uoffset_t>(3 * r + c));
    T.t[r] = stored.t_m()->Get(static_cast<flatbuffers::uoffset_t>(r));
  }
  return T;
}

Mat66 to_covariance(const fbs::Covariance& stored) {
  Mat66 cov;
  flatbuffers::uoffset_t next = 0;
  for (int r = 0; r < 6; ++r)
    for (int c = r; c < 6; ++c) cov(r, c) = cov(c, r) = static_cast<double>(stored.upper()->Get(next++));
  return cov;
}

// Sizes beyond any image become 0, which check_record() refuses.
int to_size_px(uint32_t stored) { return stored <= 1U << 20 ? static_cast<int>(stored) : 0; }

camera::Intrinsics to_intrinsics(const fbs::Intrinsics& stored) {
  camera::Intrinsics k{static_cast<camera::Model>(stored.model()),
                       to_size_px(stored.width_px()),
                       to_size_px(stored.height_px()),
                       stored.fx_px(),
                       stored.fy_px(),
                       stored.cx_px(),
                       stored.cy_px(),
                       {}};
  for (std::size_t i = 0; i < k.distortion.size(); ++i)
    k.distortion[i] = stored.distortion()->Get(static_cast<flatbuffers::uoffset_t>(i));
  return k;
}

bool take(const fbs::Sensor& stored, SensorRecord& out) {
  if (!take(stored.name(), out.name) || !take(stored.model(), out.model) || !take(stored.serial(), out.serial))
    return false;
  out.kind = static_cast<SensorKind>(stored.kind());
  out.T_rig_sensor = to_se3(*stored.pose_rig());
  out.cov_rig_sensor = to_covariance(*stored.covariance());
  out.intrinsics = stored.intrinsics() == nullptr ? camera::Intrinsics{} : to_intrinsics(*stored.intrinsics());
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
    if (!out.reasons.push_back({}) || !take(reason, out.reasons.back())) return false;
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

Status check_header(std::span<const std::byte> bytes, RecordHeader& header) {
  if (bytes.size() < sizeof header) return corrupt("shorter than a record's header");
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.magic != kMagic) return corrupt("no record begins here");
  if (crc32c(bytes.first(offsetof(RecordHeader, header_crc32c))) != header.header_crc32c)
    return corrupt("the record's header is damaged");
  if (header.version != kFormatVersion)
    return {StatusCode::kUnsupported, "the record is of another version; update the firmware or the tool"};
  if (header.payload_bytes > kMaxRecordBytes - sizeof header) return corrupt("the record's header is damaged");
  return ok_status();
}

}  // namespace

Result<std::size_t> record_size(std::span<const std::byte> bytes) {
  RecordHeader header{};
  ROOMCAL_TRY(check_header(bytes, header));
  return sizeof header + header.payload_bytes;
}

Status decode_record(std::span<const std::byte> bytes, Record& record) {
  if (reinterpret_cast<uintptr_t>(bytes.data()) % 8 != 0)
    return {StatusCode::kInvalidArgument, "the record's bytes are not aligned to 8"};
  RecordHeader header{};
  ROOMCAL_TRY(check_header(bytes, header));
  if (bytes.size() - sizeof header < header.payload_bytes) return corrupt("the record is cut short");
  const std::span<const std::byte> payload = bytes.subspan(sizeof header, header.payload_bytes);
  if (crc32c(payload) != header.payload_crc32c) return corrupt("the record's content is damaged");

  flatbuffers::Verifier verifier(reinterpret_cast<const uint8_t*>(payload.data()), payload.size(), 8, 64);
  if (!fbs::VerifyRecordBuffer(verifier)) return corrupt("the record's structure is broken");
  const fbs::Record& stored = *fbs::GetRecord(payload.data());
  const bool fits = take(stored.map_id(), record.map_id) && take(stored.firmware_id(), record.firmware_id) &&
                    take(stored.device_serial(), record.device_serial) && take_reasons(stored, record) &&
                    take_sensors(stored, record);
  if (!fits) return corrupt("the record holds more or longer entries than its version allows");
  take_figures(stored, record);
  return check_record(record);
}

}  // namespace roomcal::store
