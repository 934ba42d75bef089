#pragma once

#include <array>
#include <optional>
#include <variant>

#include "board/common/can_side.h"
#include "board/common/event_log.h"
#include "board/common/files.h"
#include "board/common/image_driver.h"
#include "board/common/memory_plan.h"
#include "board/common/packet_driver.h"
#include "board/common/press_thread.h"
#include "board/common/sensor_threads.h"
#include "drivers/gige/action_trigger.h"
#include "drivers/gpio/gpio_trigger.h"
#include "drivers/os/linux_clocks.h"
#include "drivers/os/locked_memory.h"
#include "drivers/store/fd_medium.h"
#include "drivers/thermal/sysfs_thermometer.h"
#if ROOMCAL_ARAVIS || ROOMCAL_LIBCAMERA
#include "drivers/relay/software_trigger.h"
#endif
#include "runtime/grab/sweep_tray.h"
#include "runtime/grab/turntable_tray.h"
#include "runtime/map/triangle_index.h"
#include "runtime/scan/surface.h"

namespace roomcal::board {

inline constexpr std::string_view kFirmware = ROOMCAL_FIRMWARE;

struct MachineOptions {
  const Capacities* board = nullptr;
  Folder folder;
  /// Bytes of the block that may be used; less than the plan only to see what start-up does then.
  std::size_t starve_bytes = SIZE_MAX;
};

/// Sensors, store and session of one device: reserved, opened, armed. Everything that lives longer than a call is in
/// one locked block, or in this object.
///
///     files -> plan -> memory -> store -> map -> sensors -> session -> threads
class Machine {
 public:
  Machine(const MachineOptions& options, const drivers::LinuxClocks& clocks, EventLog& log, CanSide& can);
  ~Machine();
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  /// Reads the files and works out the plan; reserves nothing. @param[out] why  as load_files() and plan_board().
  Status plan(Reason& why);
  /// After plan(): reserves, opens, starts the threads. What cannot be opened for lack of a sensor is no error: it is
  /// told and tried again for ever. Afterwards the threads make no heap call.
  /// @param[out] why  names the part and the remedy.
  Status arm(Reason& why);
  bool armed() const { return armed_; }
  void disarm();

  const BoardPlan& board_plan() const { return plan_; }
  const profile::Profile* profile() const { return files_.profile.get(); }
  /// The map's bytes in memory still are what was read.
  bool map_intact() const { return map::RoomMap::open(map_file_).ok(); }
  const map::RoomMap* map() const { return armed_ ? &map_ : nullptr; }
  store::Store* store() { return store_open_ ? &store_ : nullptr; }
  press::Press* press() { return press_ ? &*press_ : nullptr; }
  const press::Look& look() const { return *look_; }
  PressThread& press_thread() { return press_thread_; }
  const calib::Device& device() const { return device_; }

  /// Another sensor of motion, before arm(); outlives the machine.
  void watch_motion(ports::StillnessSensor& sensor) { static_cast<void>(sources_.stillness.push_back(&sensor)); }
  /// The shot was taken: a replay goes on to the next one.
  void advance_replay();
  void examine(face::Vitals& vitals);
  /// The thread that has been silent for longest. @return how long, ns.
  int64_t longest_silence_ns(int64_t now_ns) const;

 private:
  Status reserve(Reason& why);
  Status open_store(Reason& why);
  Status place_map(Reason& why);
  Status open_cameras(Reason& why);
  Status open_lidars(Reason& why);
  Status open_lidar(std::size_t i, Reason& why);
  void open_thermometer();
  Status open_trigger(Reason& why);
  Status settle_trigger(Reason& why);
  Status gather_software_trigger(Reason& why);
  Status make_session(Reason& why);
  Status start_threads(Reason& why);
  Status fail(Status status, std::string_view part, Reason& why);
  grab::GrabOptions grab_options() const;

  MachineOptions options_;
  const drivers::LinuxClocks& clocks_;
  EventLog& log_;
  CanSide& can_;

  LoadedFiles files_;
  BoardPlan plan_;
  drivers::LockedMemory memory_;
  Arena arena_;
  std::span<std::byte> session_block_;
  std::optional<Arenas> arenas_;

  drivers::FdMedium medium_;
  store::Store store_;
  bool store_open_ = false;

  calib::Device device_;
  map::RoomMap map_;
  std::span<const std::byte> map_file_;
  map::TriangleIndex index_;
  scan::Surface surface_;

  drivers::LinuxV4l2Kernel v4l2_;
  drivers::LinuxFileKernel files_kernel_;
  drivers::ReplayCursor replay_;
  std::array<ImageDriver, calib::kMaxCameras> image_drivers_;
  std::array<PacketDriver, calib::kMaxLidars> packet_drivers_;
  std::array<grab::ImageRing, calib::kMaxCameras> rings_;
  std::array<grab::SweepTray, calib::kMaxLidars> trays_;
  grab::TurntableTray turntable_;  ///< one servo, one profiler
  std::variant<std::monostate, drivers::GpioTrigger, drivers::ActionTrigger
#if ROOMCAL_ARAVIS || ROOMCAL_LIBCAMERA
               ,
               drivers::SoftwareTrigger
#endif
               >
      trigger_;
  grab::Sources sources_;
  store::Serial synchronization_;  ///< what makes the cameras expose, in a word or two
  Reason trigger_trouble_;         ///< why it is not what the profile asks for
  std::optional<drivers::SysfsThermometer> thermometer_;

  std::optional<calib::Session> session_;
  std::optional<grab::Grabber> grabber_;
  std::optional<press::Press> press_;
  std::optional<press::Look> look_;

  std::array<CameraThread, calib::kMaxCameras> camera_threads_;
  LidarThread lidar_thread_;
  PressThread press_thread_;
  std::array<drivers::Thread, calib::kMaxCameras + 2> threads_;
  FixedVector<ThreadLink*, calib::kMaxCameras + 2> links_;
  int64_t armed_ns_ = 0;
  bool armed_ = false;
};

}  // namespace roomcal::board
