#include "tools/provision/profile_file.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "runtime/calib/limit_table.h"
#include "runtime/camera/flat.h"
#include "runtime/profile/format.h"
#include "runtime/profile/profile_generated.h"
#include "tools/common/error.h"

namespace roomcal::tools {

namespace {

namespace fbs = profile::fbs;
using Builder = flatbuffers::FlatBufferBuilder;
using Text = flatbuffers::Offset<flatbuffers::String>;

template <std::size_t kCapacity>
Text put(Builder& builder, const FixedText<kCapacity>& text) {
  return builder.CreateString(text.view().data(), text.view().size());
}

flatbuffers::Offset<fbs::Mounting> put(Builder& builder, const calib::NominalMounting& nominal) {
  if (!nominal.known) return 0;
  const auto T = camera::to_flat_transform<fbs::Transform>(nominal.T_rig_sensor);
  return fbs::CreateMounting(builder, &T, nominal.sigma_rot_rad, nominal.sigma_t_m);
}

flatbuffers::Offset<fbs::CameraWiring> put(Builder& builder, const profile::CameraWiring& w) {
  std::vector<Text> formats;
  for (const profile::ShortText& format : w.formats) formats.push_back(put(builder, format));
  const auto formats_at = builder.CreateVector(formats);
  const Text key = put(builder, w.key), name = put(builder, w.trigger_setting.name),
             value = put(builder, w.trigger_setting.value);
  return fbs::CreateCameraWiring(builder, static_cast<uint8_t>(w.driver), key, formats_at, w.rate_hz, w.exposure_us,
                                 w.gain, static_cast<uint8_t>(w.trigger), name, value, w.buffers, w.ptp,
                                 w.may_reset_port, static_cast<uint8_t>(w.stamp_point), w.packet_size_bytes,
                                 w.packet_delay_us, static_cast<uint8_t>(w.sync), w.sync_frames);
}

flatbuffers::Offset<fbs::Camera> put(Builder& builder, const profile::CameraProfile& camera) {
  const auto wiring = put(builder, camera.wiring);
  const auto nominal = put(builder, camera.nominal);
  const Text name = put(builder, camera.name), serial = put(builder, camera.serial);
  const auto intrinsics = camera::to_flat_intrinsics<fbs::Intrinsics>(camera.intrinsics);
  return fbs::CreateCamera(builder, name, serial, &intrinsics, camera.sigma_px, nominal, wiring);
}

flatbuffers::Offset<fbs::OusterFormat> put(Builder& builder, const lidar::OusterFormat& f) {
  const std::vector<int16_t> shift(f.pixel_shift.begin(), f.pixel_shift.end());
  std::vector<double> T;
  for (int i = 0; i < 16; ++i) T.push_back(f.T_sensor_lidar(i / 4, i % 4));
  const auto shift_at = builder.CreateVector(shift);
  const auto T_at = builder.CreateVector(T);
  return fbs::CreateOusterFormat(builder, static_cast<uint8_t>(f.profile), f.columns_per_frame, f.columns_per_packet,
                                 f.first_column, f.last_column, shift_at, f.beam_origin_m, f.beam_origin_z_m, T_at,
                                 f.serial);
}

flatbuffers::Offset<fbs::LidarWiring> put(Builder& builder, const profile::LidarWiring& w) {
  const Text sender = put(builder, w.sender), local = put(builder, w.local), group = put(builder, w.group),
             interface = put(builder, w.interface);
  return fbs::CreateLidarWiring(builder, static_cast<uint8_t>(w.driver), w.port, sender, w.sender_port, local, group,
                                interface, w.sweeps);
}

flatbuffers::Offset<fbs::Lidar> put(Builder& builder, const profile::LidarProfile& lidar) {
  const lidar::Calibration& c = lidar.calibration;
  std::vector<fbs::Beam> beams;
  for (std::size_t i = 0; i < c.beam_count; ++i) {
    const lidar::Beam& b = c.beams[i];
    beams.emplace_back(b.elevation_rad, b.azimuth_offset_rad, b.range_offset_m, b.vertical_offset_m,
                       b.horizontal_offset_m);
  }
  const auto beams_at = builder.CreateVectorOfStructs(beams);
  const auto ouster =
      c.model == lidar::Model::kOuster ? put(builder, c.ouster) : flatbuffers::Offset<fbs::OusterFormat>();
  const auto wiring = put(builder, lidar.wiring);
  const auto nominal = put(builder, lidar.nominal);
  const Text name = put(builder, lidar.name), serial = put(builder, lidar.serial), model = put(builder, lidar.model);
  const lidar::TurntableMounting& m = lidar.turntable;
  const fbs::Turntable turntable(std::array<double, 3>{m.axis_lidar.x(), m.axis_lidar.y(), m.axis_lidar.z()},
                                 camera::to_flat_transform<fbs::Transform>(m.T_lidar_profiler));
  return fbs::CreateLidar(builder, name, serial, model, c.from_unit, c.dual_returns, beams_at, ouster, nominal, wiring,
                          lidar.on_turntable ? &turntable : nullptr);
}

flatbuffers::Offset<fbs::Wiring> put(Builder& builder, const profile::Wiring& w) {
  const Text trigger_line = put(builder, w.trigger.line), button_line = put(builder, w.button.line),
             light_line = put(builder, w.light.line);
  const Text chip = put(builder, w.trigger.chip), address = put(builder, w.trigger.address),
             button = put(builder, w.button.path), light = put(builder, w.light.path),
             console = put(builder, w.console.path), can = put(builder, w.can.interface),
             watchdog = put(builder, w.watchdog.path), store = put(builder, w.store.path),
             replay = put(builder, w.replay_folder), imu = put(builder, w.imu.path),
             thermometer = put(builder, w.thermometer.path);
  return fbs::CreateWiring(builder, static_cast<uint8_t>(w.trigger.kind), chip, trigger_line, w.trigger.pulse_us,
                           address, w.trigger.device_key, w.trigger.group_key, w.trigger.group_mask,
                           static_cast<uint8_t>(w.button.kind), button, w.button.code, button_line, w.button.active_low,
                           w.button.debounce_us, static_cast<uint8_t>(w.light.kind), light, light_line,
                           w.light.active_low, console, w.console.baud, can, w.can.standstill, w.servo.node,
                           w.servo.counts_per_turn, w.servo.velocity_units_per_count,
                           w.servo.acceleration_units_per_count, w.servo.homing_method, w.servo.half_turn_s, watchdog,
                           w.watchdog.timeout_s, static_cast<uint8_t>(w.store.kind), store, w.store.size_bytes,
                           w.store.page_bytes, replay, imu, w.trigger.lead_us, w.trigger.may_run_free, thermometer);
}

std::vector<flatbuffers::Offset<fbs::Limit>> put(Builder& builder, const calib::Limits& limits) {
  std::vector<flatbuffers::Offset<fbs::Limit>> stored;
  for (const calib::LimitField& field : calib::limit_table()) {
    const double value = get_limit(limits, field);
    if (value == get_limit(calib::Limits(), field)) continue;
    stored.push_back(fbs::CreateLimit(builder, builder.CreateString(field.name.data(), field.name.size()), value));
  }
  return stored;
}

void put(Builder& builder, const profile::Profile& profile) {
  std::vector<flatbuffers::Offset<fbs::Camera>> cameras;
  for (const profile::CameraProfile& camera : profile.cameras) cameras.push_back(put(builder, camera));
  std::vector<flatbuffers::Offset<fbs::Lidar>> lidars;
  for (const profile::LidarProfile& lidar : profile.lidars) lidars.push_back(put(builder, lidar));
  const auto cameras_at = builder.CreateVector(cameras);
  const auto lidars_at = builder.CreateVector(lidars);
  const auto limits_at = builder.CreateVector(put(builder, profile.limits));
  const auto wiring = put(builder, profile.wiring);
  const auto grab = fbs::CreateGrab(builder, profile.grab.patience_s, profile.grab.image_wait_s,
                                    profile.grab.max_spread_ms, profile.grab.still_px);
  const Text device = put(builder, profile.device), serial = put(builder, profile.serial);
  fbs::FinishProfileBuffer(builder, fbs::CreateProfile(builder, device, serial, static_cast<uint8_t>(profile.reference),
                                                       cameras_at, lidars_at, limits_at, grab, wiring));
}

AlignedBytes to_bytes(const profile::Profile& profile) {
  Builder builder(64 * 1024);
  put(builder, profile);
  const std::span<const std::byte> payload = std::as_bytes(std::span(builder.GetBufferPointer(), builder.GetSize()));
  const SealedHeader header = seal(payload, profile::kProfileKind);
  AlignedBytes bytes(sizeof header + payload.size());
  std::memcpy(bytes.span().data(), &header, sizeof header);
  std::memcpy(bytes.span().data() + sizeof header, payload.data(), payload.size());
  return bytes;
}

}  // namespace

AlignedBytes build_profile(const profile::Profile& profile) {
  Reason what;
  if (!check_profile(profile, what).ok()) throw ToolError("profile: " + std::string(what.view()));
  AlignedBytes bytes = to_bytes(profile);
  const auto back = std::make_unique<profile::Profile>();
  if (!profile::decode_profile(bytes.span(), *back, what).ok()) throw ToolError("profile: " + std::string(what.view()));
  const AlignedBytes again = to_bytes(*back);
  if (!std::ranges::equal(bytes.span(), again.span()))
    throw ToolError("profile: a field does not come back as it was written; this is a bug of ours, please report it");
  return bytes;
}

profile::Profile read_profile(const std::filesystem::path& path) {
  const AlignedBytes bytes = read_bytes(path);
  profile::Profile profile;
  Reason what;
  if (!profile::decode_profile(bytes.span(), profile, what).ok())
    throw ToolError(path.string() + ": " + std::string(what.view()));
  return profile;
}

}  // namespace roomcal::tools
