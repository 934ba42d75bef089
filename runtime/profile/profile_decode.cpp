#include "runtime/calib/lidar_models.h"
#include "runtime/calib/limit_table.h"
#include "runtime/camera/flat.h"
#include "runtime/profile/format.h"
#include "runtime/profile/profile.h"
#include "runtime/profile/profile_generated.h"

namespace roomcal::profile {

namespace {

using camera::take_text;

constexpr Status kTooMuch{
    StatusCode::kCorrupt,
    "the profile holds more, longer or other entries than this firmware takes: make it anew with `roomcal provision`"};

template <typename Enum>
bool take_enum(uint8_t stored, Enum last, Enum& out) {
  if (stored > static_cast<uint8_t>(last)) return false;
  out = static_cast<Enum>(stored);
  return true;
}

void take(const fbs::Mounting* stored, calib::NominalMounting& out) {
  out = {};
  if (stored == nullptr) return;
  out = {true, camera::to_se3(*stored->pose_rig()), stored->sigma_rot_rad(), stored->sigma_t_m()};
}

bool take(const fbs::CameraWiring& stored, CameraWiring& out) {
  out.rate_hz = stored.rate_hz();
  out.exposure_us = stored.exposure_us();
  out.gain = stored.gain();
  out.buffers = stored.buffers();
  out.ptp = stored.ptp();
  out.may_reset_port = stored.may_reset_port();
  out.packet_size_bytes = stored.packet_size_bytes();
  out.packet_delay_us = stored.packet_delay_us();
  out.sync_frames = stored.sync_frames();
  if (stored.formats() != nullptr)
    for (const flatbuffers::String* format : *stored.formats())
      if (!out.formats.push_back({}) || !take_text(format, out.formats.back())) return false;
  return take_enum(stored.driver(), ImageDriver::kAravis, out.driver) && take_text(stored.key(), out.key) &&
         take_enum(stored.trigger(), TriggerMode::kAction, out.trigger) &&
         take_enum(stored.stamp_point(), StampPoint::kExposureEnd, out.stamp_point) &&
         take_enum(stored.sync(), SyncRole::kClient, out.sync) &&
         take_text(stored.trigger_name(), out.trigger_setting.name) &&
         take_text(stored.trigger_value(), out.trigger_setting.value);
}

bool take(const fbs::Camera& stored, CameraProfile& out) {
  out.intrinsics = camera::to_intrinsics(*stored.intrinsics());
  out.sigma_px = stored.sigma_px();
  take(stored.nominal(), out.nominal);
  return take_text(stored.name(), out.name) && take_text(stored.serial(), out.serial) &&
         take(*stored.wiring(), out.wiring);
}

bool take(const fbs::LidarWiring& stored, LidarWiring& out) {
  out.port = stored.port();
  out.sender_port = stored.sender_port();
  out.sweeps = stored.sweeps();
  return take_enum(stored.driver(), PacketDriver::kUdp, out.driver) && take_text(stored.sender(), out.sender) &&
         take_text(stored.local(), out.local) && take_text(stored.group(), out.group) &&
         take_text(stored.interface(), out.interface);
}

bool take(const fbs::OusterFormat& stored, lidar::OusterFormat& out) {
  out.columns_per_frame = stored.columns_per_frame();
  out.columns_per_packet = stored.columns_per_packet();
  out.first_column = stored.first_column();
  out.last_column = stored.last_column();
  out.beam_origin_m = stored.beam_origin_m();
  out.beam_origin_z_m = stored.beam_origin_z_m();
  out.serial = stored.serial();
  const auto* shift = stored.pixel_shift();
  const auto* T = stored.sensor_lidar();
  if (shift == nullptr || shift->size() > out.pixel_shift.size() || T == nullptr || T->size() != 16) return false;
  for (flatbuffers::uoffset_t i = 0; i < shift->size(); ++i) out.pixel_shift[i] = shift->Get(i);
  for (flatbuffers::uoffset_t i = 0; i < 16; ++i) out.T_sensor_lidar(i / 4, i % 4) = T->Get(i);
  return take_enum(stored.profile(), lidar::OusterProfile::kFiveWord, out.profile);
}

/// @return kCorrupt for beams, or an Ouster's format, that are none.
Status take_calibration(const fbs::Lidar& stored, const lidar::ModelInfo& model, lidar::Calibration& out) {
  FixedVector<lidar::Beam, lidar::kMaxBeams> beams;
  for (const fbs::Beam* beam : *stored.beams())
    if (!beams.push_back({beam->elevation_rad(), beam->azimuth_offset_rad(), beam->range_offset_m(),
                          beam->vertical_offset_m(), beam->horizontal_offset_m()}))
      return kTooMuch;
  lidar::OusterFormat ouster;
  const bool is_ouster = model.model == lidar::Model::kOuster;
  if (is_ouster && (stored.ouster() == nullptr || !take(*stored.ouster(), ouster))) return kTooMuch;
  Result<lidar::Calibration> made =
      is_ouster ? lidar::make_calibration(ouster, beams.span()) : lidar::make_calibration(model.model, beams.span());
  if (!made.ok()) return {StatusCode::kCorrupt, made.status().detail()};
  out = made.value();
  out.from_unit = stored.from_unit();
  out.dual_returns = stored.dual_returns();
  return ok_status();
}

void take(const fbs::Turntable* stored, LidarProfile& out) {
  out.on_turntable = stored != nullptr;
  if (stored == nullptr) return;
  for (flatbuffers::uoffset_t i = 0; i < 3; ++i) out.turntable.axis_lidar[i] = stored->axis_lidar()->Get(i);
  out.turntable.T_lidar_profiler = camera::to_se3(stored->pose_lidar());
}

Status take(const fbs::Lidar& stored, LidarProfile& out) {
  take(stored.nominal(), out.nominal);
  take(stored.turntable(), out);
  if (!take_text(stored.name(), out.name) || !take_text(stored.serial(), out.serial) ||
      !take_text(stored.model(), out.model) || !take(*stored.wiring(), out.wiring))
    return kTooMuch;
  const lidar::ModelInfo* model = calib::packets_of(out.model.view());
  if (model == nullptr)
    return {StatusCode::kUnsupported,
            "the profile names a LiDAR model that this firmware does not know: update the firmware"};
  return take_calibration(stored, *model, out.calibration);
}

bool take_trigger(const fbs::Wiring& stored, TriggerWiring& out) {
  out.pulse_us = stored.trigger_pulse_us();
  out.device_key = stored.trigger_device_key();
  out.group_key = stored.trigger_group_key();
  out.group_mask = stored.trigger_group_mask();
  out.lead_us = stored.trigger_lead_us();
  out.may_run_free = stored.trigger_may_run_free();
  return take_enum(stored.trigger_kind(), TriggerKind::kCan, out.kind) && take_text(stored.trigger_chip(), out.chip) &&
         take_text(stored.trigger_line(), out.line) && take_text(stored.trigger_address(), out.address);
}

bool take_face(const fbs::Wiring& stored, Wiring& out) {
  out.button.code = stored.button_code();
  out.button.active_low = stored.button_active_low();
  out.button.debounce_us = stored.button_debounce_us();
  out.light.active_low = stored.light_active_low();
  out.console.baud = stored.console_baud();
  return take_enum(stored.button_kind(), ButtonKind::kLine, out.button.kind) &&
         take_text(stored.button_path(), out.button.path) && take_text(stored.button_line(), out.button.line) &&
         take_enum(stored.light_kind(), LightKind::kLine, out.light.kind) &&
         take_text(stored.light_path(), out.light.path) && take_text(stored.light_line(), out.light.line) &&
         take_text(stored.console_path(), out.console.path);
}

bool take(const fbs::Wiring& stored, Wiring& out) {
  out.can.standstill = stored.can_standstill();
  out.servo = {stored.servo_node(),
               stored.servo_counts_per_turn(),
               stored.servo_velocity_units_per_count(),
               stored.servo_acceleration_units_per_count(),
               stored.servo_homing_method(),
               stored.servo_half_turn_s()};
  out.watchdog.timeout_s = stored.watchdog_timeout_s();
  out.store.size_bytes = stored.store_size_bytes();
  out.store.page_bytes = stored.store_page_bytes();
  return take_trigger(stored, out.trigger) && take_face(stored, out) &&
         take_text(stored.can_interface(), out.can.interface) && take_text(stored.watchdog_path(), out.watchdog.path) &&
         take_enum(stored.store_kind(), StoreKind::kNvmem, out.store.kind) &&
         take_text(stored.store_path(), out.store.path) && take_text(stored.replay_folder(), out.replay_folder) &&
         take_text(stored.imu_path(), out.imu.path) && take_text(stored.thermometer_path(), out.thermometer.path);
}

Status take_sensors(const fbs::Profile& stored, Profile& out) {
  for (const fbs::Camera* camera : *stored.cameras())
    if (!out.cameras.push_back({}) || !take(*camera, out.cameras.back())) return kTooMuch;
  if (stored.lidars() == nullptr) return ok_status();
  for (const fbs::Lidar* lidar : *stored.lidars()) {
    if (!out.lidars.push_back({})) return kTooMuch;
    ROOMCAL_TRY(take(*lidar, out.lidars.back()));
  }
  return ok_status();
}

Status take_limits(const fbs::Profile& stored, calib::Limits& out) {
  if (stored.limits() == nullptr) return ok_status();
  for (const fbs::Limit* limit : *stored.limits()) {
    const calib::LimitField* field = calib::find_limit({limit->name()->c_str(), limit->name()->size()});
    if (field == nullptr || !set_limit(out, *field, limit->value()))
      return {StatusCode::kUnsupported,
              "the profile has a limit that this firmware does not know, or no number for it: make it anew with the "
              "`roomcal provision` of this firmware"};
  }
  return ok_status();
}

void take_grab(const fbs::Grab* stored, GrabWiring& out) {
  if (stored == nullptr) return;
  out = {stored->patience_s(), stored->image_wait_s(), stored->max_spread_ms(), stored->still_px()};
}

Status decode(std::span<const std::byte> bytes, Profile& profile) {
  const Result<std::span<const std::byte>> opened = open_sealed(bytes, kProfileKind);
  ROOMCAL_TRY(opened.status());
  const std::span<const std::byte> payload = opened.value();
  flatbuffers::Verifier verifier(reinterpret_cast<const uint8_t*>(payload.data()), payload.size(), 16, 1024);
  if (!fbs::VerifyProfileBuffer(verifier))
    return {StatusCode::kCorrupt, "the profile's structure is broken: make it anew with `roomcal provision`"};
  const fbs::Profile& stored = *fbs::GetProfile(payload.data());
  profile = Profile();
  profile.reference = stored.reference();
  if (!take_text(stored.device(), profile.device) || !take_text(stored.serial(), profile.serial)) return kTooMuch;
  ROOMCAL_TRY(take_sensors(stored, profile));
  ROOMCAL_TRY(take_limits(stored, profile.limits));
  take_grab(stored.grab(), profile.grab);
  return stored.wiring() == nullptr || take(*stored.wiring(), profile.wiring) ? ok_status() : kTooMuch;
}

}  // namespace

Status decode_profile(std::span<const std::byte> bytes, Profile& profile, Reason& what) {
  what.clear();
  Status read = decode(bytes, profile);
  if (!read.ok()) what = read.detail();
  if (read.ok() && !check_profile(profile, what).ok())
    read = {StatusCode::kCorrupt, "the profile holds values that cannot be: make it anew with `roomcal provision`"};
  return read;
}

}  // namespace roomcal::profile
