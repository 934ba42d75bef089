#include <array>
#include <cassert>
#include <cstring>

#include <flatbuffers/flatbuffers.h>

#include "runtime/camera/flat.h"
#include "runtime/store/record_codec.h"
#include "runtime/store/record_generated.h"

namespace roomcal::store {

namespace {

using Builder = flatbuffers::FlatBufferBuilder;
using Text = flatbuffers::Offset<flatbuffers::String>;

// The builder asks once for everything; the limits of format.h keep it from ever asking again.
class FixedAllocator final : public flatbuffers::Allocator {
 public:
  explicit FixedAllocator(std::span<std::byte> bytes) : bytes_(bytes) {}
  uint8_t* allocate(std::size_t size) override {
    assert(!taken_ && size <= bytes_.size());
    taken_ = true;
    return size <= bytes_.size() ? reinterpret_cast<uint8_t*>(bytes_.data()) : nullptr;
  }
  void deallocate(uint8_t* /*bytes*/, std::size_t /*size*/) override { taken_ = false; }

 private:
  std::span<std::byte> bytes_;
  bool taken_ = false;
};

Text put(Builder& builder, std::string_view text) { return builder.CreateString(text.data(), text.size()); }

fbs::Covariance to_fbs(const Mat66& cov) {
  std::array<float, 21> upper{};
  std::size_t next = 0;
  for (int r = 0; r < 6; ++r)
    for (int c = r; c < 6; ++c) upper[next++] = static_cast<float>(cov(r, c));
  return fbs::Covariance(upper);
}

fbs::Evidence to_fbs(const Evidence& e) {
  return {e.detections, e.inliers, static_cast<float>(e.rms), static_cast<float>(e.coverage),
          static_cast<float>(e.log_likelihood_gap)};
}

flatbuffers::Offset<fbs::Sensor> put(Builder& builder, const SensorRecord& sensor) {
  const Text name = put(builder, sensor.name.view());
  const Text model = put(builder, sensor.model.view());
  const Text serial = put(builder, sensor.serial.view());
  const fbs::Transform T_rig_sensor = camera::to_flat_transform<fbs::Transform>(sensor.T_rig_sensor);
  const fbs::Covariance covariance = to_fbs(sensor.cov_rig_sensor);
  const fbs::Intrinsics intrinsics = camera::to_flat_intrinsics<fbs::Intrinsics>(sensor.intrinsics);
  const fbs::Evidence evidence = to_fbs(sensor.evidence);
  const fbs::Intrinsics* of_camera = sensor.kind == SensorKind::kCamera ? &intrinsics : nullptr;
  return fbs::CreateSensor(builder, name, static_cast<uint8_t>(sensor.kind), model, serial, &T_rig_sensor, &covariance,
                           of_camera, &evidence);
}

void put(Builder& builder, const Record& record) {
  std::array<flatbuffers::Offset<fbs::Sensor>, kMaxSensors> sensors;
  for (std::size_t i = 0; i < record.sensors.size(); ++i) sensors[i] = put(builder, record.sensors[i]);
  std::array<Text, kMaxReasons> reasons;
  for (std::size_t i = 0; i < record.reasons.size(); ++i) reasons[i] = put(builder, record.reasons[i].view());
  const auto sensors_at = builder.CreateVector(sensors.data(), record.sensors.size());
  const auto reasons_at = builder.CreateVector(reasons.data(), record.reasons.size());
  const Text map_id = put(builder, record.map_id.view());
  const Text firmware_id = put(builder, record.firmware_id.view());
  const Text device_serial = put(builder, record.device_serial.view());
  const Text trigger = put(builder, record.trigger.view());
  builder.Finish(
      fbs::CreateRecord(builder, record.generation, record.content_generation, record.previous_content,
                        static_cast<uint8_t>(record.action), static_cast<uint8_t>(record.verdict), reasons_at, map_id,
                        record.map_hash, firmware_id, device_serial, record.measured_unix_s, record.written_unix_s,
                        static_cast<float>(record.temperature_c), record.chi2, record.degrees_of_freedom,
                        static_cast<uint8_t>(record.reference), sensors_at, trigger),
      fbs::RecordIdentifier());
}

}  // namespace

Result<std::size_t> encode_record(const Record& record, std::span<std::byte> out, std::span<std::byte> scratch) {
  if (scratch.size() < kEncodeScratchBytes || reinterpret_cast<uintptr_t>(scratch.data()) % 16 != 0)
    return Status(StatusCode::kInvalidArgument, "encoding a record takes 16 KiB of scratch, aligned to 16");
  ROOMCAL_TRY(check_record(record));
  FixedAllocator allocator(scratch);
  Builder builder(scratch.size(), &allocator, false, 16);
  put(builder, record);
  const std::span<const std::byte> payload = std::as_bytes(std::span(builder.GetBufferPointer(), builder.GetSize()));
  const SealedHeader header = seal(payload, kRecordKind);
  const std::size_t size = sizeof header + payload.size();
  if (size > out.size())
    return Status(StatusCode::kCapacity, "the record is larger than a slot; give the store a larger medium");
  std::memcpy(out.data(), &header, sizeof header);
  std::memcpy(out.data() + sizeof header, payload.data(), payload.size());
  return size;
}

}  // namespace roomcal::store
