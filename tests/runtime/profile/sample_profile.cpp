#include "tests/runtime/profile/sample_profile.h"

#include <algorithm>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "runtime/calib/lidar_models.h"
#include "runtime/calib/limit_table.h"
#include "tools/device/wiring_yaml.h"

namespace roomcal::profile::test {

namespace {

calib::NominalMounting mounted(double x_m, double turn_rad) {
  calib::NominalMounting nominal{true, SE3(), 0.02, 0.005};
  nominal.T_rig_sensor = {so3_exp(Vec3(0.1, turn_rad, -0.2)), Vec3(x_m, -0.02, 0.3)};
  return nominal;
}

CameraProfile camera_of(std::string_view name, camera::Model model) {
  CameraProfile camera;
  camera.name = name;
  camera.intrinsics = {model, 1280, 720, 612.25, 612.5, 634.875, 362.125, {-0.019, 0.0045, -0.0018, 0.0003}};
  return camera;
}

CameraWiring filled_wiring(ImageDriver driver, std::string_view key) {
  CameraWiring w;
  w.driver = driver;
  w.key = key;
  static_cast<void>(w.formats.push_back("GREY"));
  static_cast<void>(w.formats.push_back("YUYV"));
  w.rate_hz = 29.97;
  w.exposure_us = 2000;
  w.gain = 1.5;
  w.trigger = TriggerMode::kLine;
  w.trigger_setting = {"trigger_mode", "1"};
  w.buffers = 6;
  w.ptp = w.may_reset_port = true;
  w.stamp_point = StampPoint::kExposureMiddle;
  w.packet_size_bytes = 1400;
  w.packet_delay_us = 12.5;
  w.sync = SyncRole::kServer;
  w.sync_frames = 60;
  return w;
}

LidarWiring filled_wiring(uint16_t port) {
  LidarWiring w;
  w.driver = PacketDriver::kUdp;
  w.port = port;
  w.sender = "192.168.1.201";
  w.sender_port = 2400;
  w.local = "192.168.1.10";
  w.group = "239.0.0.1";
  w.interface = "eth1";
  w.sweeps = 5;
  return w;
}

Wiring filled_wiring() {
  Wiring w;
  w.trigger = {TriggerKind::kLine, "/dev/gpiochip0", "trig-out", 500, "192.168.1.255", 7, 2, 3, 2000, true};
  w.button = {ButtonKind::kEvdev, "/dev/input/event0", 141, "key-calibrate", false, 5000};
  w.light = {LightKind::kLed, "/sys/class/leds/calibrate", "led-1", true};
  w.console = {"/dev/ttyS1", 57'600};
  w.can = {"can0", true};
  w.servo = {5, -65'536, 0.5, 0.25, 3, 20};
  w.thermometer = {"/sys/class/thermal/thermal_zone0/temp"};
  w.watchdog = {"/dev/watchdog", 20};
  w.store = {StoreKind::kFile, "/var/lib/roomcal/store", 262'144, 512};
  w.replay_folder = "shots";
  return w;
}

std::vector<lidar::Beam> made_up_beams(std::size_t count) {
  std::vector<lidar::Beam> beams(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count);
    beams[i] = {0.5 - share, 0.01 * share, 0.001 + 1e-4 * share, -0.002 * share, 0.003 * share};
  }
  return beams;
}

lidar::OusterFormat ouster_format(std::size_t rows) {
  lidar::OusterFormat format;
  format.profile = lidar::OusterProfile::kDual19;
  format.columns_per_frame = 2048;
  format.columns_per_packet = 8;
  format.first_column = 100;
  format.last_column = 1900;
  for (std::size_t i = 0; i < rows; ++i) format.pixel_shift[i] = static_cast<int16_t>(static_cast<int>(i) - 30);
  format.beam_origin_m = 0.0158;
  format.beam_origin_z_m = 0.001;
  format.T_sensor_lidar.topRightCorner<3, 1>() = Vec3(0.001, -0.002, 0.0362);
  format.serial = 0x1234'5678'9ABC;
  return format;
}

std::string numbers(const SE3& T) {
  std::vector<double> all(T.R.data(), T.R.data() + 9);
  all.insert(all.end(), T.t.data(), T.t.data() + 3);
  return fmt::format("{}", fmt::join(all, " "));
}

std::string text_of(const calib::NominalMounting& n) {
  return n.known ? fmt::format("nominal {} {} {}\n", numbers(n.T_rig_sensor), n.sigma_rot_rad, n.sigma_t_m) : "";
}

std::string text_of(const CameraProfile& camera) {
  const camera::Intrinsics& k = camera.intrinsics;
  return fmt::format("camera {} serial '{}' model {} {}x{} {} {} {} {} d {} sigma {}\n{}driver {}\n",
                     camera.name.view(), camera.serial.view(), static_cast<int>(k.model), k.width_px, k.height_px,
                     k.fx_px, k.fy_px, k.cx_px, k.cy_px, fmt::join(k.distortion, " "), camera.sigma_px,
                     text_of(camera.nominal), tools::to_text(camera.wiring));
}

std::string text_of(const lidar::OusterFormat& f) {
  std::vector<double> T(f.T_sensor_lidar.data(), f.T_sensor_lidar.data() + 16);
  return fmt::format("ouster {} {} {} {}..{} shift {} origin {} {} T {} serial {}\n", static_cast<int>(f.profile),
                     f.columns_per_frame, f.columns_per_packet, f.first_column, f.last_column,
                     fmt::join(f.pixel_shift, " "), f.beam_origin_m, f.beam_origin_z_m, fmt::join(T, " "), f.serial);
}

std::string text_of(const lidar::TurntableMounting& table) {
  return fmt::format("turntable about {} {} {} at {}\n", table.axis_lidar.x(), table.axis_lidar.y(),
                     table.axis_lidar.z(), numbers(table.T_lidar_profiler));
}

std::string text_of(const LidarProfile& lidar) {
  const lidar::Calibration& c = lidar.calibration;
  std::string text =
      fmt::format("lidar {} serial '{}' model {} packets {} from_unit {} dual {}\n", lidar.name.view(),
                  lidar.serial.view(), lidar.model.view(), static_cast<int>(c.model), c.from_unit, c.dual_returns);
  for (std::size_t i = 0; i < c.beam_count; ++i)
    text += fmt::format("beam {} {} {} {} {} sine {}\n", c.beams[i].elevation_rad, c.beams[i].azimuth_offset_rad,
                        c.beams[i].range_offset_m, c.beams[i].vertical_offset_m, c.beams[i].horizontal_offset_m,
                        c.trig[i].sin_elevation);
  if (c.model == lidar::Model::kOuster) text += text_of(c.ouster);
  if (lidar.on_turntable) text += text_of(lidar.turntable);
  return text + text_of(lidar.nominal) + "driver " + tools::to_text(lidar.wiring) + "\n";
}

}  // namespace

LidarProfile lidar_of(std::string_view name, std::string_view model) {
  constexpr std::size_t kOusterRows = 32;
  LidarProfile lidar;
  lidar.name = name;
  lidar.model = model;
  const lidar::ModelInfo& packets = *calib::packets_of(model);
  const bool is_ouster = packets.model == lidar::Model::kOuster;
  const std::vector<lidar::Beam> beams = made_up_beams(is_ouster ? kOusterRows : packets.beams);
  lidar.calibration = is_ouster ? lidar::make_calibration(ouster_format(kOusterRows), beams).value()
                                : lidar::make_calibration(packets.model, beams).value();
  return lidar;
}

Profile full_profile() {
  Profile profile;
  profile.device = "robot 7";
  profile.serial = "RB-0042";
  profile.reference = 1;
  for (const auto& [name, model, driver] :
       {std::tuple("cam0", camera::Model::kKannalaBrandt, ImageDriver::kV4l2),
        std::tuple("cam1", camera::Model::kPinholeRadtan, ImageDriver::kAravis),
        std::tuple("cam2", camera::Model::kPinholeRadtan, ImageDriver::kLibcamera)}) {
    CameraProfile camera = camera_of(name, model);
    const std::string number = std::to_string(profile.cameras.size());
    camera.serial = std::string_view("C-" + number);
    camera.sigma_px = 0.15;
    camera.wiring = filled_wiring(driver, "key-" + number);
    if (profile.cameras.size() != profile.reference) camera.nominal = mounted(0.1, 0.4);
    static_cast<void>(profile.cameras.push_back(camera));
  }
  for (const auto& [name, model, port] :
       {std::tuple("lidar0", "vlp16", 2368), std::tuple("lidar1", "os1", 7502), std::tuple("lidar2", "tls", 2105)}) {
    LidarProfile lidar = lidar_of(name, model);
    lidar.serial = std::string_view(fmt::format("L-{}", port));
    lidar.nominal = mounted(-0.2, 1.2);
    lidar.wiring = filled_wiring(static_cast<uint16_t>(port));
    lidar.calibration.from_unit = true;
    static_cast<void>(profile.lidars.push_back(lidar));
  }
  profile.lidars[2].on_turntable = true;
  profile.lidars[2].turntable = {Vec3(0, 0.6, 0.8), {so3_exp(Vec3(0.1, 0.2, 0.3)), Vec3(0.01, -0.02, 0.03)}};
  for (const calib::LimitField& field : calib::limit_table()) {
    const double value = get_limit(calib::Limits(), field);
    static_cast<void>(set_limit(profile.limits, field, field.whole() ? value + 1 : std::min(0.9 * value, field.most)));
  }
  profile.grab = {20, 2.5, 4, 0.25};
  profile.wiring = filled_wiring();
  return profile;
}

Profile small_profile() {
  Profile profile;
  profile.device = "one";
  static_cast<void>(profile.cameras.push_back(camera_of("cam0", camera::Model::kPinholeRadtan)));
  return profile;
}

std::string text_of(const Profile& profile) {
  std::string text = fmt::format("device '{}' serial '{}' reference {}\n", profile.device.view(), profile.serial.view(),
                                 profile.reference);
  for (const CameraProfile& camera : profile.cameras) text += text_of(camera);
  for (const LidarProfile& lidar : profile.lidars) text += text_of(lidar);
  for (const calib::LimitField& field : calib::limit_table())
    text += fmt::format("limit {} {}\n", field.name, get_limit(profile.limits, field));
  return text + "grab " + tools::to_text(profile.grab) + "\n" + tools::wiring_text(profile.wiring);
}

}  // namespace roomcal::profile::test
