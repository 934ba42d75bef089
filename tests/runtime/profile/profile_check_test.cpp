// Every thing that check_profile() refuses, by the one line that names it.

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/profile/ipv4.h"
#include "runtime/profile/profile.h"
#include "tests/runtime/profile/sample_profile.h"

namespace roomcal::profile {
namespace {

using test::full_profile;
using test::small_profile;

const double kNan = std::numeric_limits<double>::quiet_NaN();

/// A part of some kind with nothing filled in.
template <typename Part, typename Kind>
Part bare(Kind kind) {
  Part part;
  part.kind = kind;
  return part;
}

/// Empty if the profile can work.
std::string complaint(const Profile& profile) {
  Reason what = "left from before";
  const Status checked = check_profile(profile, what);
  EXPECT_EQ(checked.ok(), what.empty());
  EXPECT_TRUE(checked.ok() || checked.code() == StatusCode::kInvalidArgument);
  return std::string(what.view());
}

struct Case {
  std::function<void(Profile&)> spoil;
  std::string expected;
};

void expect_refusals(const std::vector<Case>& cases) {
  for (const Case& c : cases) {
    Profile profile = full_profile();
    c.spoil(profile);
    EXPECT_EQ(complaint(profile), c.expected);
  }
}

TEST(CheckProfile, SampleProfiles_CanWork) {
  EXPECT_EQ(complaint(full_profile()), "");
  EXPECT_EQ(complaint(small_profile()), "");
}

TEST(CheckProfile, Device_IsNamed) {
  const std::string bad_text = "device: its name is empty, or name or serial are not of printable characters";
  expect_refusals({
      {[](Profile& p) { p.device.clear(); }, bad_text},
      {[](Profile& p) { p.device = "caf\xC3\xA9"; }, bad_text},
      {[](Profile& p) { p.serial = "R\t1"; }, bad_text},
      {[](Profile& p) { p.cameras.clear(); }, "device: it has no camera; one at least is the reference"},
      {[](Profile& p) { p.reference = 3; }, "device: the reference sensor is not one of the cameras"},
      {[](Profile& p) { p.reference = SIZE_MAX; }, "device: the reference sensor is not one of the cameras"},
  });
}

TEST(CheckProfile, Identity_NamesTheSensor) {
  expect_refusals({
      {[](Profile& p) { p.cameras[2].name = "cam 2"; }, "camera 2: its name is not of letters, digits, _ - ."},
      {[](Profile& p) { p.lidars[1].name.clear(); }, "LiDAR 1: its name is not of letters, digits, _ - ."},
      {[](Profile& p) { p.cameras[2].name = "../cam"; }, "camera 2: its name is not of letters, digits, _ - ."},
      {[](Profile& p) { p.cameras[2].name = "cam0"; }, "cam0: two sensors have this name: rename one"},
      {[](Profile& p) { p.lidars[1].name = "cam1"; }, "cam1: two sensors have this name: rename one"},
      {[](Profile& p) { p.cameras[2].serial = "C-0"; }, "cam0: another sensor has its serial: read it off both"},
      {[](Profile& p) { p.lidars[0].serial = "C-1"; }, "cam1: another sensor has its serial: read it off both"},
      {[](Profile& p) { p.lidars[0].serial = "\x01"; }, "lidar0: its serial is not of printable characters"},
  });
}

TEST(CheckProfile, SerialsThatAreNotGiven_MayBeAlike) {
  Profile profile = full_profile();
  for (CameraProfile& camera : profile.cameras) camera.serial.clear();
  for (LidarProfile& lidar : profile.lidars) lidar.serial.clear();
  EXPECT_EQ(complaint(profile), "");
}

TEST(CheckProfile, Mounting_NamesTheSensor) {
  const std::string none = "its nominal mounting is none: a rotation, at most 100 m, sigmas above 0";
  expect_refusals({
      {[](Profile& p) { p.cameras[0].nominal.T_rig_sensor.R(0, 0) += 1e-3; }, "cam0: " + none},
      {[](Profile& p) { p.cameras[0].nominal.T_rig_sensor.R.col(0) *= -1; }, "cam0: " + none},
      {[](Profile& p) { p.cameras[0].nominal.T_rig_sensor.R(1, 1) = kNan; }, "cam0: " + none},
      {[](Profile& p) { p.lidars[0].nominal.T_rig_sensor.t.x() = 101; }, "lidar0: " + none},
      {[](Profile& p) { p.lidars[0].nominal.T_rig_sensor.t.y() = kNan; }, "lidar0: " + none},
      {[](Profile& p) { p.lidars[1].nominal.sigma_t_m = 0; }, "lidar1: " + none},
      {[](Profile& p) { p.lidars[1].nominal.sigma_t_m = 11; }, "lidar1: " + none},
      {[](Profile& p) { p.lidars[1].nominal.sigma_t_m = kNan; }, "lidar1: " + none},
      {[](Profile& p) { p.lidars[1].nominal.sigma_rot_rad = -0.1; }, "lidar1: " + none},
      {[](Profile& p) { p.lidars[1].nominal.sigma_rot_rad = 4; }, "lidar1: " + none},
      {[](Profile& p) { p.cameras[1].nominal = p.cameras[0].nominal; },
       "cam1: it is the reference: its nominal mounting is the identity, or left out"},
  });
  Profile profile = full_profile();
  profile.cameras[1].nominal = {true, SE3(), 0.01, 0.01};
  EXPECT_EQ(complaint(profile), "");
}

TEST(CheckProfile, Camera_IsNamed) {
  const std::string key = "cam0: its driver has no key to find it by: see the driver's README";
  const std::string none = "cam0: its intrinsics are none: import them again";
  expect_refusals({
      {[](Profile& p) { p.cameras[0].intrinsics.fx_px = 0; }, none},
      {[](Profile& p) { p.cameras[0].intrinsics.width_px = 0; }, none},
      {[](Profile& p) { p.cameras[0].intrinsics.distortion[1] = kNan; }, none},
      {[](Profile& p) { p.cameras[0].sigma_px = -0.1; }, "cam0: sigma_px is not between 0 and 5"},
      {[](Profile& p) { p.cameras[0].sigma_px = kNan; }, "cam0: sigma_px is not between 0 and 5"},
      {[](Profile& p) { p.cameras[0].wiring.key.clear(); }, key},
      {[](Profile& p) { p.cameras[0].wiring.rate_hz = -1; }, "cam0: rate_hz is not between 0 and 1000"},
      {[](Profile& p) { p.cameras[0].wiring.exposure_us = 61e6; }, "cam0: exposure_us is not between 0 and 60 s"},
      {[](Profile& p) { p.cameras[0].wiring.gain = -2; }, "cam0: gain is not between 0 and 1e6, nor -1 for its own"},
      {[](Profile& p) { p.cameras[0].wiring.gain = kNan; }, "cam0: gain is not between 0 and 1e6, nor -1 for its own"},
      {[](Profile& p) { p.cameras[0].wiring.buffers = 1; }, "cam0: buffers is not between 2 and 16"},
      {[](Profile& p) { p.cameras[0].wiring.buffers = 17; }, "cam0: buffers is not between 2 and 16"},
      {[](Profile& p) { p.cameras[0].wiring.packet_size_bytes = 575; },
       "cam0: packet_size_bytes is not between 576 and 16260, nor 0 for the camera's own"},
      {[](Profile& p) { p.cameras[0].wiring.packet_size_bytes = 16'261; },
       "cam0: packet_size_bytes is not between 576 and 16260, nor 0 for the camera's own"},
      {[](Profile& p) { p.cameras[0].wiring.packet_delay_us = -2; },
       "cam0: packet_delay_us is not between 0 and 1e6, nor -1 for the camera's own"},
      {[](Profile& p) { p.cameras[0].wiring.packet_delay_us = kNan; },
       "cam0: packet_delay_us is not between 0 and 1e6, nor -1 for the camera's own"},
      {[](Profile& p) { p.cameras[0].wiring.sync_frames = 0; },
       "cam0: sync_frames is 0; the server needs some to find the beat"},
  });
}

TEST(CheckProfile, CameraOfARecording_NeedsNoKey) {
  Profile profile = full_profile();
  profile.cameras[0].wiring = CameraWiring();
  EXPECT_EQ(complaint(profile), "");
}

TEST(CheckProfile, TwoCamerasThatWouldBeTheSameOne_AreNamed) {
  Profile profile = full_profile();
  profile.cameras[2].wiring = profile.cameras[0].wiring;
  EXPECT_EQ(complaint(profile), "cam2: another camera has its driver's key: find each by a key of its own");
  profile.cameras[2].wiring.driver = ImageDriver::kLibcamera;  // of another driver's world
  EXPECT_EQ(complaint(profile), "");
}

TEST(CheckProfile, Lidar_IsNamed) {
  const std::string addresses = "lidar0: sender, local and group are addresses such as 192.168.1.201";
  expect_refusals({
      {[](Profile& p) { p.lidars[0].model = "vlp17"; },
       "lidar0: its model is not known: `roomcal sweep --help` lists them"},
      {[](Profile& p) { p.lidars[0].model = "xt16"; }, "lidar0: its angles are of another model"},
      {[](Profile& p) { p.lidars[0].wiring.sweeps = 0; }, "lidar0: a shot joins one to 32 sweeps"},
      {[](Profile& p) { p.lidars[0].wiring.sweeps = 33; }, "lidar0: a shot joins one to 32 sweeps"},
      {[](Profile& p) { p.lidars[0].wiring.port = 0; },
       "lidar0: its driver has no port: give the one that the sensor sends to"},
      {[](Profile& p) { p.lidars[0].wiring.sender = "lidar.local"; }, addresses},
      {[](Profile& p) { p.lidars[0].wiring.local = "192.168.1"; }, addresses},
      {[](Profile& p) { p.lidars[0].wiring.group = "239.0.0.256"; }, addresses},
      {[](Profile& p) { p.lidars[0].wiring.interface.clear(); },
       "lidar0: a multicast group needs the network interface towards the sensor"},
      {[](Profile& p) { p.lidars[0].wiring.interface = "an-interface-name"; },
       "lidar0: no interface has a name like that: see `ip link`"},
  });
}

TEST(CheckProfile, LidarsThatWouldTakeEachOthersPackets_AreNamed) {
  const std::string mixed =
      "lidar1: another LiDAR sends to the same port: set another one in the sensor and here, or, of a group, give both "
      "their sender";
  Profile profile = full_profile();
  LidarWiring &a = profile.lidars[0].wiring, &b = profile.lidars[1].wiring;
  b = a;
  EXPECT_EQ(complaint(profile), mixed);  // of one group, one sender
  b.sender = "192.168.1.202";
  EXPECT_EQ(complaint(profile), "");
  b.sender.clear();
  EXPECT_EQ(complaint(profile), mixed);
  b.group.clear();
  EXPECT_EQ(complaint(profile), "");  // one of a group, one of its own
  a.group.clear();
  EXPECT_EQ(complaint(profile), mixed);  // a port of one's own has one owner, whoever sends
  b.local = "192.168.2.10";
  EXPECT_EQ(complaint(profile), "");
  b.local.clear();
  EXPECT_EQ(complaint(profile), mixed);
  b.port = 2369;
  EXPECT_EQ(complaint(profile), "");
}

TEST(CheckProfile, LimitsAndGrab_AreNamed) {
  expect_refusals({
      {[](Profile& p) { p.limits.min_inliers = 5; }, "limits: min_inliers is not between 6 and 500"},
      {[](Profile& p) { p.limits.max_sigma_t_m = 0; }, "limits: max_sigma_t_m is not between 1e-06 and 1"},
      {[](Profile& p) { p.limits.moved_p_value = kNan; }, "limits: moved_p_value is not between 1e-12 and 0.5"},
      {[](Profile& p) { p.grab.patience_s = 0.4; }, "grab: patience_s is not between 0.5 and 600"},
      {[](Profile& p) { p.grab.image_wait_s = kNan; }, "grab: image_wait_s is not between 0.05 and 120"},
      {[](Profile& p) { p.grab.max_spread_ms = -1; }, "grab: max_spread_ms is not between 0 and 10000"},
      {[](Profile& p) { p.grab.still_px = 0; }, "grab: still_px is not between 0.01 and 100"},
  });
}

TEST(CheckProfile, Wiring_NamesThePart) {
  const std::string page = "store: its page size is not a power of two up to 65536";
  const std::string small = "store: its file is too small; it takes 11 slots of 1 KiB or more, in whole pages";
  const std::string action = "trigger: an action command needs an address such as 192.168.1.255";
  const std::string key = "button: an input device needs its path and the key's code: see evtest";
  expect_refusals({
      {[](Profile& p) { p.wiring.store.page_bytes = 500; }, page},
      {[](Profile& p) { p.wiring.store.page_bytes = 131072; }, page},
      {[](Profile& p) { p.wiring.store.size_bytes = 11 * 1024 - 1; }, small},
      {[](Profile& p) {
         p.wiring.store = {StoreKind::kFile, "s", 11 * 4096 - 1, 4096};
       },
       small},
      {[](Profile& p) { p.wiring.store.size_bytes = (64U << 20) + 1; }, "store: a file takes 64 MiB at the most"},
      {[](Profile& p) { p.wiring.trigger.line.clear(); }, "trigger: it has no line: give its name or number"},
      {[](Profile& p) { p.wiring.trigger.pulse_us = 0; }, "trigger: pulse_us is not between 1 and 1000000"},
      {[](Profile& p) { p.wiring.trigger.pulse_us = 1000001; }, "trigger: pulse_us is not between 1 and 1000000"},
      {[](Profile& p) {
         p.wiring.trigger.kind = TriggerKind::kAction;
         p.wiring.trigger.lead_us = 1000001;
       },
       "trigger: lead_us is not between 0 and 1000000"},
      {[](Profile& p) { p.wiring.trigger = bare<TriggerWiring>(TriggerKind::kAction); }, action},
      {[](Profile& p) {
         p.wiring.trigger = bare<TriggerWiring>(TriggerKind::kAction);
         p.wiring.trigger.address = "all";
       },
       action},
      {[](Profile& p) {
         p.wiring.trigger = bare<TriggerWiring>(TriggerKind::kCan);
         p.wiring.can = CanWiring();
       },
       "trigger: over CAN needs wiring.can.interface"},
      {[](Profile& p) { p.wiring.button.path.clear(); }, key},
      {[](Profile& p) { p.wiring.button.code = 0; }, key},
      {[](Profile& p) { p.wiring.button.code = 0x300; }, key},
      {[](Profile& p) { p.wiring.button = bare<ButtonWiring>(ButtonKind::kLine); },
       "button: it has no line: give its name or number"},
      {[](Profile& p) { p.wiring.light.path.clear(); }, "light: it has no path: give its folder below /sys/class/leds"},
      {[](Profile& p) { p.wiring.light = bare<LightWiring>(LightKind::kLine); },
       "light: it has no line: give its name or number"},
      {[](Profile& p) { p.wiring.console.baud = 300; },
       "console: baud is not between 9600 and 3000000, nor 0 to leave the line as it is"},
      {[](Profile& p) { p.wiring.can.interface = "a/can"; }, "can: no interface has a name like that: see `ip link`"},
      {[](Profile& p) { p.wiring.can.interface.clear(); }, "can: standstill needs wiring.can.interface"},
      {[](Profile& p) { p.wiring.can = CanWiring(); }, "servo: it needs wiring.can.interface"},
      {[](Profile& p) { p.wiring.watchdog.timeout_s = 1; }, "watchdog: its timeout is not between 2 and 600 s"},
      {[](Profile& p) { p.wiring.watchdog.timeout_s = 601; }, "watchdog: its timeout is not between 2 and 600 s"},
  });
}

TEST(CheckProfile, Servo_NamesTheField) {
  const std::string units = "servo: velocity or acceleration units per count are not between 1e-9 and 1e9";
  const double infinity = std::numeric_limits<double>::infinity();
  expect_refusals({
      {[](Profile& p) { p.wiring.servo.node = 127; }, "servo: its node is not between 1 and 126; 127 is our own"},
      {[](Profile& p) { p.wiring.servo.counts_per_turn = 0; }, "servo: counts_per_turn is not between 1 and 1e9"},
      {[](Profile& p) { p.wiring.servo.counts_per_turn = kNan; }, "servo: counts_per_turn is not between 1 and 1e9"},
      {[](Profile& p) { p.wiring.servo.velocity_units_per_count = 0; }, units},
      {[=](Profile& p) { p.wiring.servo.velocity_units_per_count = infinity; }, units},
      {[](Profile& p) { p.wiring.servo.acceleration_units_per_count = -1; }, units},
      {[](Profile& p) { p.wiring.servo.half_turn_s = 0.4; }, "servo: half_turn_s is not between 0.5 and 600"},
  });
}

TEST(CheckProfile, Turntable_NamesTheSensor) {
  const std::string none = "lidar2: its turntable is none: a unit axis, a rotation, at most 100 m";
  expect_refusals({
      {[](Profile& p) { p.lidars[2].turntable.axis_lidar.setZero(); }, none},
      {[](Profile& p) { p.lidars[2].turntable.axis_lidar.x() = kNan; }, none},
      {[](Profile& p) { p.lidars[2].turntable.T_lidar_profiler.R(0, 1) += 0.1; }, none},
      {[](Profile& p) { p.lidars[2].turntable.T_lidar_profiler.t.y() = kNan; }, none},
      {[](Profile& p) { p.wiring.servo.node = 0; }, "lidar2: it is on a turntable: give wiring.servo its node"},
      {[](Profile& p) { p.lidars[0].on_turntable = true; }, "lidar0: only a 2-D profiler sits on a turntable"},
      {[](Profile& p) {
         p.lidars[0] = p.lidars[2];
         p.lidars[0].name = "other";
         p.lidars[0].serial.clear();
       },
       "lidar2: another LiDAR is on the turntable already"},
  });
}

TEST(CheckProfile, PartsThatAreNotThere_NeedNothing) {
  Profile profile = full_profile();
  profile.lidars.pop_back();  // the one on the turntable
  profile.wiring = Wiring();
  profile.wiring.watchdog.timeout_s = 0;  // of no watchdog
  profile.wiring.console.baud = 1;        // of no console
  EXPECT_EQ(complaint(profile), "");
}

TEST(IsIpv4, AddressesAndOthers) {
  for (const char* text : {"0.0.0.0", "255.255.255.255", "192.168.1.201", "10.0.0.1"})
    EXPECT_TRUE(is_ipv4(text)) << text;
  for (const char* text : {"", "1", "1.2.3", "1.2.3.4.5", "256.1.1.1", "1.2.3.04", "01.2.3.4", "1..2.3", ".1.2.3",
                           "1.2.3.", "1.2.3.4 ", " 1.2.3.4", "a.b.c.d", "1.2.3.-4", "1.2.3.4444", "1,2,3,4"})
    EXPECT_FALSE(is_ipv4(text)) << text;
}

}  // namespace
}  // namespace roomcal::profile
