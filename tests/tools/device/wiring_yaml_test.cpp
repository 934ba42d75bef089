#include "tools/device/wiring_yaml.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/tools/device/wiring_walk.h"
#include "tests/tools/refusal.h"
#include "tools/device/device_yaml.h"

namespace roomcal::tools {
namespace {

using test::ChangeField;
using test::contains;
using test::member_count;
using test::refusal;
using test::walked_fields;

/// What follows "key: " in a text of one line.
template <typename Read>
auto parse(const std::string& key, const std::string& fields, const Read& read) {
  const YamlText yaml("d.yaml", key + ": " + fields + "\n");
  return read(yaml, yaml.root()[key]);
}
profile::CameraWiring parse_camera(const std::string& fields) {
  return parse("driver", fields, [](const YamlText& yaml, const YAML::Node& node) {
    return read_camera_wiring(yaml, node, "cam0: driver");
  });
}
profile::LidarWiring parse_lidar(const std::string& fields) {
  return parse("driver", fields, [](const YamlText& yaml, const YAML::Node& node) {
    return read_lidar_wiring(yaml, node, "lidar0: driver");
  });
}
profile::GrabWiring parse_grab(const std::string& fields) {
  return parse("grab", fields, [](const YamlText& yaml, const YAML::Node& node) { return read_grab(yaml, node); });
}
profile::Wiring parse_wiring(const std::string& sections) {
  const YamlText yaml("d.yaml", sections);
  return read_wiring(yaml, yaml.root()["wiring"]);
}

TEST(WiringFields, EveryMemberOfEveryStruct_IsWalkedOver) {
  // One member of a camera's wiring has two fields: the trigger's setting.
  EXPECT_EQ(walked_fields<profile::CameraWiring>(), member_count<profile::CameraWiring>() + 1);
  EXPECT_EQ(member_count<profile::NamedSetting>(), 2U);
  EXPECT_EQ(walked_fields<profile::LidarWiring>(), member_count<profile::LidarWiring>());
  EXPECT_EQ(walked_fields<profile::GrabWiring>(), member_count<profile::GrabWiring>());
  EXPECT_EQ(walked_fields<profile::TriggerWiring>(), member_count<profile::TriggerWiring>());
  EXPECT_EQ(walked_fields<profile::ButtonWiring>(), member_count<profile::ButtonWiring>());
  EXPECT_EQ(walked_fields<profile::LightWiring>(), member_count<profile::LightWiring>());
  EXPECT_EQ(walked_fields<profile::ConsoleWiring>(), member_count<profile::ConsoleWiring>());
  EXPECT_EQ(walked_fields<profile::CanWiring>(), member_count<profile::CanWiring>());
  EXPECT_EQ(walked_fields<profile::ServoWiring>(), member_count<profile::ServoWiring>());
  EXPECT_EQ(walked_fields<profile::ThermometerWiring>(), member_count<profile::ThermometerWiring>());
  EXPECT_EQ(walked_fields<profile::WatchdogWiring>(), member_count<profile::WatchdogWiring>());
  EXPECT_EQ(walked_fields<profile::StoreWiring>(), member_count<profile::StoreWiring>());
  std::size_t sections = 1;  // replay is a text, not a section
  profile::Wiring wiring;
  walk_sections(wiring, [&](std::string_view, auto&) { ++sections; });
  EXPECT_EQ(sections, member_count<profile::Wiring>());
}

TEST(CameraWiring, EveryKey_FillsItsField) {
  const profile::CameraWiring w = parse_camera(
      "{kind: aravis, key: \"Basler-1\", formats: [Mono8, Mono12], rate_hz: 29.97, exposure_us: 2000, gain: 1.5, "
      "trigger: action, trigger_name: Line1, trigger_value: RisingEdge, buffers: 6, ptp: true, may_reset_port: true, "
      "stamp_point: end, packet_size_bytes: 8000, packet_delay_us: 12.5, sync: client, sync_frames: 30}");
  EXPECT_EQ(w.driver, profile::ImageDriver::kAravis);
  EXPECT_EQ(w.key.view(), "Basler-1");
  ASSERT_EQ(w.formats.size(), 2U);
  EXPECT_EQ(w.formats[1].view(), "Mono12");
  EXPECT_EQ(w.rate_hz, 29.97);
  EXPECT_EQ(w.exposure_us, 2000);
  EXPECT_EQ(w.gain, 1.5);
  EXPECT_EQ(w.trigger, profile::TriggerMode::kAction);
  EXPECT_EQ(w.trigger_setting.name.view(), "Line1");
  EXPECT_EQ(w.trigger_setting.value.view(), "RisingEdge");
  EXPECT_EQ(w.buffers, 6U);
  EXPECT_TRUE(w.ptp);
  EXPECT_TRUE(w.may_reset_port);
  EXPECT_EQ(w.stamp_point, profile::StampPoint::kExposureEnd);
  EXPECT_EQ(w.packet_size_bytes, 8000U);
  EXPECT_EQ(w.packet_delay_us, 12.5);
  EXPECT_EQ(w.sync, profile::SyncRole::kClient);
  EXPECT_EQ(w.sync_frames, 30U);
}

TEST(LidarWiring, EveryKey_FillsItsField) {
  const profile::LidarWiring w = parse_lidar(
      "{kind: udp, port: 2369, sender: 192.168.1.201, sender_port: 2400, local: 192.168.1.10, group: 239.0.0.1, "
      "interface: eth1, sweeps: 5}");
  EXPECT_EQ(w.driver, profile::PacketDriver::kUdp);
  EXPECT_EQ(w.port, 2369U);
  EXPECT_EQ(w.sender.view(), "192.168.1.201");
  EXPECT_EQ(w.sender_port, 2400U);
  EXPECT_EQ(w.local.view(), "192.168.1.10");
  EXPECT_EQ(w.group.view(), "239.0.0.1");
  EXPECT_EQ(w.interface.view(), "eth1");
  EXPECT_EQ(w.sweeps, 5U);
}

TEST(GrabWiring, EveryKey_FillsItsField) {
  const profile::GrabWiring g = parse_grab("{patience_s: 20, image_wait_s: 2.5, max_spread_ms: 4, still_px: 0.25}");
  EXPECT_EQ(g.patience_s, 20);
  EXPECT_EQ(g.image_wait_s, 2.5);
  EXPECT_EQ(g.max_spread_ms, 4);
  EXPECT_EQ(g.still_px, 0.25);
}

TEST(Wiring, EverySection_FillsItsStruct) {
  const profile::Wiring w = parse_wiring(
      "wiring:\n"
      "  trigger: {kind: line, line: trig-out, chip: /dev/gpiochip0, pulse_us: 500, address: 10.0.0.255, "
      "device_key: 7, group_key: 2, group_mask: 3, lead_us: 1500}\n"
      "  button: {kind: evdev, path: /dev/input/event0, code: 141, line: 4, active_low: false, debounce_us: 5000}\n"
      "  light: {kind: led, path: /sys/class/leds/calibrate, line: 5, active_low: true}\n"
      "  console: {path: /dev/ttyS1, baud: 57600}\n"
      "  can: {interface: can0, standstill: true}\n"
      "  servo: {node: 5, counts_per_turn: -65536, velocity_units_per_count: 0.5, acceleration_units_per_count: 0.25, "
      "homing_method: -3, half_turn_s: 20}\n"
      "  watchdog: {path: /dev/watchdog, timeout_s: 20}\n"
      "  store: {kind: nvmem, path: /sys/eeprom, size_bytes: 65536, page_bytes: 64}\n"
      "  replay: shots\n");
  EXPECT_EQ(w.trigger.kind, profile::TriggerKind::kLine);
  EXPECT_EQ(w.trigger.line.view(), "trig-out");
  EXPECT_EQ(w.trigger.chip.view(), "/dev/gpiochip0");
  EXPECT_EQ(w.trigger.pulse_us, 500U);
  EXPECT_EQ(w.trigger.address.view(), "10.0.0.255");
  EXPECT_EQ(w.trigger.device_key, 7U);
  EXPECT_EQ(w.trigger.group_key, 2U);
  EXPECT_EQ(w.trigger.group_mask, 3U);
  EXPECT_EQ(w.trigger.lead_us, 1500U);
  EXPECT_EQ(w.button.kind, profile::ButtonKind::kEvdev);
  EXPECT_EQ(w.button.path.view(), "/dev/input/event0");
  EXPECT_EQ(w.button.code, 141U);
  EXPECT_EQ(w.button.line.view(), "4");
  EXPECT_FALSE(w.button.active_low);
  EXPECT_EQ(w.button.debounce_us, 5000U);
  EXPECT_EQ(w.light.kind, profile::LightKind::kLed);
  EXPECT_EQ(w.light.path.view(), "/sys/class/leds/calibrate");
  EXPECT_EQ(w.light.line.view(), "5");
  EXPECT_TRUE(w.light.active_low);
  EXPECT_EQ(w.console.path.view(), "/dev/ttyS1");
  EXPECT_EQ(w.console.baud, 57600U);
  EXPECT_EQ(w.can.interface.view(), "can0");
  EXPECT_TRUE(w.can.standstill);
  EXPECT_EQ(w.servo.node, 5U);
  EXPECT_EQ(w.servo.counts_per_turn, -65536);
  EXPECT_EQ(w.servo.velocity_units_per_count, 0.5);
  EXPECT_EQ(w.servo.acceleration_units_per_count, 0.25);
  EXPECT_EQ(w.servo.homing_method, -3);
  EXPECT_EQ(w.servo.half_turn_s, 20);
  EXPECT_EQ(w.watchdog.path.view(), "/dev/watchdog");
  EXPECT_EQ(w.watchdog.timeout_s, 20U);
  EXPECT_EQ(w.store.kind, profile::StoreKind::kNvmem);
  EXPECT_EQ(w.store.path.view(), "/sys/eeprom");
  EXPECT_EQ(w.store.size_bytes, 65536U);
  EXPECT_EQ(w.store.page_bytes, 64U);
  EXPECT_EQ(w.replay_folder.view(), "shots");
}

TEST(WiringChoices, EveryName_IsReadAndWritten) {
  const auto round_trip = [](const std::string& key, const auto& names, const auto& parse_one) {
    for (const std::string_view name : names) {
      const std::string written = to_text(parse_one(fmt::format("{{{}: {}}}", key, name)));
      // What is not written is the default.
      EXPECT_TRUE(contains(written, fmt::format("{}: {}", key, name)) || name == names[0]) << name << ": " << written;
    }
  };
  round_trip("kind", kImageDriverNames, parse_camera);
  round_trip("trigger", kTriggerModeNames, parse_camera);
  round_trip("stamp_point", kStampPointNames, parse_camera);
  round_trip("sync", kSyncRoleNames, parse_camera);
  round_trip("kind", kPacketDriverNames, parse_lidar);
  const auto in_section = [](const std::string& section, const auto& names) {
    for (const std::string_view name : names) {
      const std::string fields = fmt::format("  {}: {{kind: {}}}\n", section, name);
      EXPECT_EQ(wiring_text(parse_wiring("wiring:\n" + fields)), name == names[0] ? "" : "wiring:\n" + fields);
    }
  };
  in_section("trigger", kTriggerKindNames);
  in_section("button", kButtonKindNames);
  in_section("light", kLightKindNames);
  in_section("store", kStoreKindNames);
}

TEST(WiringText, DefaultsAlone_AreNotWritten) {
  EXPECT_EQ(to_text(profile::CameraWiring()), "");
  EXPECT_EQ(to_text(profile::LidarWiring()), "");
  EXPECT_EQ(to_text(profile::GrabWiring()), "");
  EXPECT_EQ(wiring_text(profile::Wiring()), "");
}

// Each field alone, whatever the struct: only it is written, and it comes back.
template <typename Wiring, typename Read>
void change_each_field(const Read& read_back) {
  for (std::size_t i = 0; i < walked_fields<Wiring>(); ++i) {
    Wiring wiring;
    ChangeField change(i);
    walk(wiring, change);
    const std::string once = to_text(wiring);
    EXPECT_TRUE(once.starts_with(fmt::format("{{{}: ", change.changed()))) << once;
    EXPECT_EQ(to_text(read_back(once)), once);
  }
}

TEST(WiringText, EachFieldAlone_IsWrittenAndComesBack) {
  change_each_field<profile::CameraWiring>(parse_camera);
  change_each_field<profile::LidarWiring>(parse_lidar);
  change_each_field<profile::GrabWiring>(parse_grab);
}

TEST(WiringText, EachFieldOfEachSectionAlone_IsWrittenAndComesBack) {
  int changed = 0;
  profile::Wiring untouched;
  walk_sections(untouched, [&](std::string_view section, auto& fields) {
    using Section = std::remove_reference_t<decltype(fields)>;
    for (std::size_t i = 0; i < walked_fields<Section>(); ++i) {
      profile::Wiring wiring;
      ChangeField change(i);
      walk_sections(wiring, [&](std::string_view key, auto& candidate) {
        if (key == section) walk(candidate, change);
      });
      const std::string once = wiring_text(wiring);
      EXPECT_TRUE(once.starts_with(fmt::format("wiring:\n  {}: {{{}: ", section, change.changed()))) << once;
      EXPECT_EQ(wiring_text(parse_wiring(once)), once);
      ++changed;
    }
  });
  EXPECT_GE(changed, 30);
}

TEST(WiringText, TextsThatYamlWouldTakeForSomethingElse_ComeBack) {
  profile::Wiring wiring;
  wiring.replay_folder = "a \"quoted\\ folder\": [x] # no\ttab";
  wiring.store.path = "yes";
  wiring.button.line = "0x10";
  const profile::Wiring back = parse_wiring(wiring_text(wiring));
  EXPECT_EQ(back.replay_folder.view(), wiring.replay_folder.view());
  EXPECT_EQ(back.store.path.view(), "yes");
  EXPECT_EQ(back.button.line.view(), "0x10");
}

TEST(Wiring, EmptyTexts_AreTaken) { EXPECT_TRUE(parse_lidar("{kind: udp, local: \"\", group: \"\"}").local.empty()); }

TEST(Wiring, EveryBadInput_NamesTheThing) {
  struct Bad {
    std::string sections, expected;
  };
  for (const Bad& bad : std::vector<Bad>{
           {"wiring: 3\n", "d.yaml:1: wiring: expected `key: value` lines"},
           {"wiring:\n  buton: {}\n", "d.yaml:2: wiring: unknown key `buton`; known are: replay, trigger, button"},
           {"wiring:\n  button: 3\n", "d.yaml:2: wiring: button: expected `key: value` lines"},
           {"wiring:\n  button: {kid: line}\n", "d.yaml:2: wiring: button: unknown key `kid`; known are: kind, path"},
           {"wiring:\n  button: {code: 1, code: 2}\n", "wiring: button: `code` stands twice"},
           {"wiring:\n  button: {kind: gpio}\n", "wiring: button: kind `gpio`; known are none, evdev, line"},
           {"wiring:\n  button: {kind: [line]}\n", "wiring: button: kind: expected a text"},
           {"wiring:\n  button: {code: many}\n", "wiring: button: code: expected a finite number, got `many`"},
           {"wiring:\n  button: {code: -1}\n", "wiring: button: code: a whole number up to 4294967295"},
           {"wiring:\n  button: {code: 1.5}\n", "wiring: button: code: a whole number up to 4294967295"},
           {"wiring:\n  button: {code: 4294967296}\n", "wiring: button: code: a whole number up to 4294967295"},
           {"wiring:\n  servo: {node: 256}\n", "wiring: servo: node: a whole number up to 255"},
           {"wiring:\n  button: {active_low: yes}\n", "wiring: button: active_low: true or false"},
           {"wiring:\n  store: {path: " + std::string(128, 'p') + "}\n", "wiring: store: path: at most 127 characters"},
           {"wiring:\n  can: {interface: [can0]}\n", "wiring: can: interface: expected a text"},
           {"wiring:\n  servo: {counts_per_turn: .nan}\n", "servo: counts_per_turn: expected a finite number"},
           {"wiring:\n  replay: [a]\n", "d.yaml:2: wiring: replay: expected a text"},
           {"wiring:\n  replay: " + std::string(128, 'p') + "\n", "wiring: replay: at most 127 characters"},
       }) {
    const std::string got = refusal([&] { static_cast<void>(parse_wiring(bad.sections)); });
    EXPECT_TRUE(contains(got, bad.expected)) << "expected: " << bad.expected << "\ngot: " << got;
    EXPECT_TRUE(got.starts_with("d.yaml:")) << got;
  }
}

TEST(CameraWiring, EveryBadInput_NamesTheSensor) {
  for (const auto& [fields, expected] : std::vector<std::pair<std::string, std::string>>{
           {"{kind: usb}", "cam0: driver: kind `usb`; known are replay, v4l2, libcamera, aravis"},
           {"{trigger: hard}", "cam0: driver: trigger `hard`; known are free, software, line, action"},
           {"{fps: 30}", "cam0: driver: unknown key `fps`"},
           {"{buffers: 65536}", "cam0: driver: buffers: a whole number up to 65535"},
           {"{formats: GREY}", "cam0: driver: formats: a list of at most 4"},
           {"{formats: [A, B, C, D, E]}", "cam0: driver: formats: a list of at most 4"},
           {"{formats: [" + std::string(32, 'f') + "]}", "cam0: driver: formats: at most 31 characters"},
           {"{formats: [[A]]}", "cam0: driver: formats: expected a text"},
           {"{ptp: 1}", "cam0: driver: ptp: true or false"},
           {"{stamp_point: begin}", "cam0: driver: stamp_point `begin`; known are unknown, start, middle, end"},
           {"{sync: both}", "cam0: driver: sync `both`; known are none, server, client"},
           {"{packet_size_bytes: -1}", "cam0: driver: packet_size_bytes: a whole number up to 65535"},
           {"{rate_hz: fast}", "cam0: driver: rate_hz: expected a finite number, got `fast`"},
       }) {
    const std::string got = refusal([&] { static_cast<void>(parse_camera(fields)); });
    EXPECT_TRUE(contains(got, "d.yaml:1: " + expected)) << "expected: " << expected << "\ngot: " << got;
  }
}

// As a whole file: the sections stand where device.yaml has them.
TEST(DeviceYaml, WithDriverGrabAndWiring_ComesBack) {
  const std::string text =
      "version: 1\nname: robot\nserial: RB-1\nrig_frame: cam0\nsensors:\n"
      "  - name: cam0\n    serial: S-1\n    kind: camera\n    model: pinhole_radtan\n    resolution_px: [640, 480]\n"
      "    intrinsics_px: [400, 400, 320, 240]\n    distortion: [0, 0, 0, 0]\n"
      "    driver: {kind: v4l2, key: \"usb-0\"}\n"
      "  - name: lidar0\n    kind: lidar\n    model: vlp16\n    calibration: lidar0.yaml\n"
      "    driver: {kind: udp, port: 2368}\n"
      "grab: {patience_s: 20}\n"
      "wiring:\n  button: {kind: line, line: \"4\"}\n  replay: \"shots\"\n";
  const Device device = parse_device_yaml("d.yaml", text);
  EXPECT_EQ(device.serial, "RB-1");
  EXPECT_EQ(device.sensors[0].serial, "S-1");
  EXPECT_EQ(device.sensors[0].camera_wiring.key.view(), "usb-0");
  EXPECT_EQ(device.sensors[1].calibration_file, "lidar0.yaml");
  EXPECT_EQ(device.sensors[1].lidar_wiring.port, 2368U);
  EXPECT_EQ(device.grab.patience_s, 20);
  EXPECT_EQ(device.wiring.button.line.view(), "4");
  const std::string once = to_device_yaml(device);
  EXPECT_EQ(to_device_yaml(parse_device_yaml("d.yaml", once)), once);
  EXPECT_TRUE(contains(once, "serial: \"RB-1\"")) << once;
  EXPECT_TRUE(contains(once, "  replay: \"shots\"\n")) << once;
}

TEST(DeviceYaml, SerialThatARecordHasNoRoomFor_IsRefusedByName) {
  const std::string head = "version: 1\nname: robot\nrig_frame: cam0\n";
  const std::string sensor =
      "sensors:\n  - name: cam0\n    kind: camera\n    model: pinhole_radtan\n    resolution_px: [640, 480]\n"
      "    intrinsics_px: [400, 400, 320, 240]\n    distortion: [0, 0, 0, 0]\n";
  const std::string too_long(32, 's');
  EXPECT_TRUE(contains(refusal([&] { parse_device_yaml("d.yaml", head + "serial: " + too_long + "\n" + sensor); }),
                       "d.yaml: serial `sss"));
  EXPECT_TRUE(contains(refusal([&] { parse_device_yaml("d.yaml", head + sensor + "    serial: \"S\\t1\"\n"); }),
                       "d.yaml: cam0: serial `S\t1`; use at most 31 characters of ASCII"));
}

}  // namespace
}  // namespace roomcal::tools
