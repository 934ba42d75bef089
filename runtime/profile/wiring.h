#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/base/fixed_text.h"
#include "runtime/base/fixed_vector.h"

/// How a device is put together: which driver brings each sensor, where button, light and store are. What people write
/// into device.yaml under `driver` and `wiring`; the board turns it into the drivers' own options.
namespace roomcal::profile {

using PathText = FixedText<127>;
using KeyText = FixedText<127>;
using ShortText = FixedText<31>;

enum class ImageDriver : uint8_t { kReplay, kV4l2, kLibcamera, kAravis };
/// When a camera exposes.
enum class TriggerMode : uint8_t {
  kFree,      ///< by itself
  kSoftware,  ///< when told so through its driver
  kLine,      ///< when its trigger input rises
  kAction,    ///< on a GigE Vision action command
};

/// Where in its exposure a camera takes the stamp of an image; the manual tells.
enum class StampPoint : uint8_t {
  kUnknown,  ///< anywhere in it: half the exposure of uncertainty
  kExposureStart,
  kExposureMiddle,
  kExposureEnd,
};
/// A camera's part where libcamera keeps several in step.
enum class SyncRole : uint8_t {
  kNone,
  kServer,  ///< gives the beat
  kClient,  ///< keeps to it
};

/// A setting by the name that the driver's own world knows: a V4L2 control, a GenICam feature.
struct NamedSetting {
  ShortText name;  ///< empty: nothing is set
  ShortText value;
};

struct CameraWiring {
  ImageDriver driver = ImageDriver::kReplay;
  KeyText key;                        ///< what finds the camera again: serial, port path, id; see the driver's README
  FixedVector<ShortText, 4> formats;  ///< pixel formats in order of preference; empty: the driver's own order
  double rate_hz = 0;                 ///< of a free-running camera; 0: its own
  double exposure_us = 0;             ///< 0: its own
  double gain = -1;                   ///< in the driver's unit; negative: its own
  TriggerMode trigger = TriggerMode::kFree;
  NamedSetting trigger_setting;  ///< what makes it obey, where something has to be set: an input's name, a control
  uint16_t buffers = 4;
  bool ptp = false;                               ///< let it follow the network's precision time
  bool may_reset_port = false;                    ///< nothing else hangs on its USB port
  StampPoint stamp_point = StampPoint::kUnknown;  ///< kAravis; the others' drivers tell it themselves
  uint16_t packet_size_bytes = 0;                 ///< kAravis on GigE; 0: the camera's own
  double packet_delay_us = -1;      ///< kAravis on GigE, for several behind one switch; negative: the camera's own
  SyncRole sync = SyncRole::kNone;  ///< kLibcamera
  uint16_t sync_frames = 100;       ///< of the server, until the beat begins
};

enum class PacketDriver : uint8_t { kReplay, kUdp };

struct LidarWiring {
  PacketDriver driver = PacketDriver::kReplay;
  uint16_t port = 0;  ///< that it sends to; 0: as the model is delivered
  ShortText sender;   ///< its address; empty: anybody's
  uint16_t sender_port = 0;
  ShortText local;      ///< own address; empty: all
  ShortText group;      ///< multicast group; empty: none
  ShortText interface;  ///< network interface; with a group it must be named
  uint16_t sweeps = 3;  ///< joined in one shot
};

enum class TriggerKind : uint8_t { kNone, kSoftware, kLine, kAction, kCan };
struct TriggerWiring {
  TriggerKind kind = TriggerKind::kNone;
  PathText chip;   ///< kLine: "/dev/gpiochip0"; empty: the line's name is looked for on all
  ShortText line;  ///< kLine: its name in the device tree, or its number on the chip
  uint32_t pulse_us = 1000;
  ShortText address;  ///< kAction: where the datagram goes, a camera's or a broadcast address
  uint32_t device_key = 0, group_key = 1, group_mask = 1;
  uint32_t lead_us = 0;  ///< kAction: the cameras expose so much later, all at one time of their PTP; 0: on receipt
  bool may_run_free =
      false;  ///< where it cannot be had, cameras run free, and it is told; else the device does not arm
};

enum class ButtonKind : uint8_t { kNone, kEvdev, kLine };
struct ButtonWiring {
  ButtonKind kind = ButtonKind::kNone;
  PathText path;           ///< kEvdev: the input device, or a pipe of its events; kLine: the chip, may be empty
  uint32_t code = 0;       ///< kEvdev: the key's number, of linux/input-event-codes.h
  ShortText line;          ///< kLine: as of the trigger
  bool active_low = true;  ///< kLine
  uint32_t debounce_us = 10'000;
};

enum class LightKind : uint8_t { kNone, kLed, kLine };
struct LightWiring {
  LightKind kind = LightKind::kNone;
  PathText path;   ///< kLed: the folder of the LED class; kLine: the chip, may be empty
  ShortText line;  ///< kLine: as of the trigger
  bool active_low = false;
};

struct ConsoleWiring {
  PathText path;  ///< a tty; empty: no console; "-": standard input and output
  uint32_t baud = 115'200;
};

struct CanWiring {
  ShortText interface;      ///< empty: no bus
  bool standstill = false;  ///< the vehicle tells whether it stands; without its word nothing is calibrated
};

/// The CiA 402 drive on the CAN bus that turns a 2-D profiler; units as drivers/cia402/servo_options.h has them.
struct ServoWiring {
  uint8_t node = 0;                    ///< CANopen node; 0: there is none
  double counts_per_turn = 1'048'576;  ///< of the table; negative: it turns the other way round
  double velocity_units_per_count = 1;
  double acceleration_units_per_count = 1;
  int8_t homing_method = 0;  ///< by the drive's manual; 0: it has an absolute encoder
  double half_turn_s = 10;   ///< that a sweep of the whole sphere takes
};

/// An IMU by Linux's IIO: without its word that the device stands still nothing is calibrated.
struct ImuWiring {
  PathText path;  ///< "/sys/bus/iio/devices/iio:device0"; empty: there is none
};

/// A temperature that goes into the record; see drivers/thermal.
struct ThermometerWiring {
  PathText path;  ///< "/sys/class/thermal/thermal_zone0/temp"; empty: there is none
};

struct WatchdogWiring {
  PathText path;  ///< empty: none
  uint32_t timeout_s = 10;
};

enum class StoreKind : uint8_t { kFile, kPartition, kNvmem };
struct StoreWiring {
  StoreKind kind = StoreKind::kFile;
  PathText path;
  uint32_t size_bytes = 196'608;  ///< of a file; of the others 0: all there is
  uint32_t page_bytes = 0;        ///< 0: as usual for the kind
};

struct Wiring {
  TriggerWiring trigger;
  ButtonWiring button;
  LightWiring light;
  ConsoleWiring console;
  CanWiring can;
  ServoWiring servo;
  ImuWiring imu;
  ThermometerWiring thermometer;
  WatchdogWiring watchdog;
  StoreWiring store;
  PathText replay_folder;  ///< of the shots that replay drivers play
};

/// How a shot is grabbed; see grab::GrabOptions.
struct GrabWiring {
  double patience_s = 10;
  double image_wait_s = 1.5;
  double max_spread_ms = 0;  ///< 0: any
  double still_px = 0.1;     ///< pictures that move by more are of a device that moves
};

}  // namespace roomcal::profile
