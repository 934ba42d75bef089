// Start-up when something is missing: every request for memory refused in turn, files that are none, profiles that ask
// for too much. Each time one line that says what and what to do; nothing that was stored is lost.

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "board/common/machine.h"
#include "board/sim/capacities.h"
#include "tests/board/board_folder.h"
#include "tests/fakes/fake_can_bus.h"
#include "tools/common/files.h"

namespace roomcal::board {
namespace {

/// One try to start a device.
struct Start {
  Start(const std::string& folder, const Capacities& board, std::size_t starve_bytes = SIZE_MAX)
      : log(clocks, false),
        bus(clocks),
        can(bus, clocks, log),
        machine({.board = &board, .folder = {folder}, .starve_bytes = starve_bytes}, clocks, log, can) {
    status = machine.plan(why);
    if (status.ok()) status = machine.arm(why);
  }
  std::string reason() const { return std::string(why.view()); }

  drivers::LinuxClocks clocks;
  EventLog log;
  fakes::FakeCanBus bus;
  CanSide can;
  Machine machine;
  Reason why;
  Status status;
};

class BoardStart : public testing::Test {
 protected:
  static void SetUpTestSuite() { folder_ = new test::BoardFolder("mobile_robot", 0.1, 40); }
  static void TearDownTestSuite() { delete folder_; }
  void SetUp() override {
    saved_ = std::make_unique<profile::Profile>(folder_->profile());
    folder_->provision();
  }
  void TearDown() override { folder_->profile() = *saved_; }

  static test::BoardFolder* folder_;
  std::unique_ptr<profile::Profile> saved_;
};
test::BoardFolder* BoardStart::folder_ = nullptr;

TEST_F(BoardStart, WithAllItNeeds_IsArmedWithinItsPlan) {
  Start start(folder_->path(), kSim);
  ASSERT_TRUE(start.status.ok()) << start.reason();
  EXPECT_TRUE(start.machine.armed());
  EXPECT_EQ(start.machine.store()->state(), store::State::kFactory);
  face::Vitals vitals;
  start.machine.examine(vitals);
  EXPECT_LE(vitals.arenas[0].peak, start.machine.board_plan().total_bytes());
  // The plan is an upper bound, and a tight one.
  EXPECT_GT(vitals.arenas[0].peak + 65'536, start.machine.board_plan().total_bytes());
}

// Each request takes the arena a step further, so an arena that ends at any byte refuses some request: every boundary
// of the plan, a byte before it, and steps in between.
TEST_F(BoardStart, EveryRequestForMemoryRefused_IsNamedAndNothingRuns) {
  Start whole(folder_->path(), kSim);
  ASSERT_TRUE(whole.status.ok()) << whole.reason();
  face::Vitals vitals;
  whole.machine.examine(vitals);
  const std::size_t needed = vitals.arenas[0].used;
  whole.machine.disarm();

  std::vector<std::size_t> ends = {0, 1, needed - 1};
  std::size_t end = 0;
  for (const PlanItem& item : whole.machine.board_plan().items) {
    end += item.bytes;
    if (end < needed) ends.insert(ends.end(), {end - 1, end});
  }
  for (std::size_t step = 1; step < 60; ++step) ends.push_back(needed * step / 60);
  for (const std::size_t bytes : ends) {
    Start start(folder_->path(), kSim, bytes);
    EXPECT_EQ(start.status.code(), StatusCode::kOutOfMemory) << bytes << " of " << needed;
    EXPECT_NE(start.reason().find(": "), std::string::npos) << start.reason();
    EXPECT_FALSE(start.machine.armed());
  }
  Start again(folder_->path(), kSim);
  EXPECT_TRUE(again.status.ok()) << again.reason();
  EXPECT_EQ(again.machine.store()->state(), store::State::kFactory) << "the store came through";
}

TEST_F(BoardStart, ProfileThatAsksForTooMuch_IsToldWhatAndWhatToDo) {
  Capacities small = kSim;
  small.cameras = 2;
  EXPECT_NE(Start(folder_->path(), small).reason().find("4 cameras, this board has room for 2"), std::string::npos);
  small = kSim;
  small.lidars = 0;
  EXPECT_NE(Start(folder_->path(), small).reason().find("1 LiDARs"), std::string::npos);
  small = kSim;
  small.image_bytes = 100;
  EXPECT_NE(Start(folder_->path(), small).reason().find("cam0: images of"), std::string::npos);
  small = kSim;
  small.map_bytes = 100;
  EXPECT_NE(Start(folder_->path(), small).reason().find("map: "), std::string::npos);
  small = kSim;
  small.sweeps = 1;
  EXPECT_NE(Start(folder_->path(), small).reason().find("lidar0: 3 sweeps"), std::string::npos);
  small = kSim;
  small.limit_bytes = 1'000'000;
  EXPECT_NE(Start(folder_->path(), small).reason().find("bytes in all"), std::string::npos);
}

TEST_F(BoardStart, FilesThatAreNone_AreNamed) {
  const std::filesystem::path folder(folder_->path());
  const std::string profile = tools::read_text(folder / "device.profile");
  tools::write_atomic(folder / "device.profile", profile.substr(0, profile.size() / 2));
  EXPECT_NE(Start(folder_->path(), kSim).reason().find("device.profile: the profile is cut short"), std::string::npos);
  tools::write_atomic(folder / "device.profile", "hello");
  EXPECT_NE(Start(folder_->path(), kSim).reason().find("device.profile"), std::string::npos);
  std::filesystem::remove(folder / "device.profile");
  EXPECT_NE(Start(folder_->path(), kSim).reason().find("No such file"), std::string::npos);
  tools::write_atomic(folder / "device.profile", profile);

  const std::string map = tools::read_text(folder / "room.room");
  std::string other = map;
  other[other.size() / 2] = static_cast<char>(other[other.size() / 2] ^ 1);
  tools::write_atomic(folder / "room.room", other);
  EXPECT_NE(Start(folder_->path(), kSim).reason().find("room.room"), std::string::npos);
  tools::write_atomic(folder / "room.room", map);
  EXPECT_TRUE(Start(folder_->path(), kSim).status.ok());
}

TEST_F(BoardStart, DriverOfAnotherProgram_IsToldAtTheStart) {
  folder_->profile().cameras[1].wiring.driver = profile::ImageDriver::kV4l2;
  folder_->profile().cameras[1].wiring.key = "port:usb-1";
  static_cast<void>(folder_->profile().cameras[1].wiring.formats.push_back("NOPE"));
  folder_->provision();
  Start start(folder_->path(), kSim);
  EXPECT_EQ(start.status.code(), StatusCode::kUnsupported);
  EXPECT_NE(start.reason().find("cam1: a pixel format"), std::string::npos) << start.reason();
}

TEST_F(BoardStart, SettingOfAnotherDriver_IsToldAtTheStart) {
  folder_->profile().cameras[1].wiring.ptp = true;
  folder_->provision();
  Start start(folder_->path(), kSim);
  EXPECT_EQ(start.status.code(), StatusCode::kUnsupported);
  EXPECT_EQ(start.reason().find("cam1: driver.ptp means nothing to replay"), 0U) << start.reason();
}

TEST_F(BoardStart, TriggerThatIsNotThere_IsNamedOrCamerasRunFreeWhereTheyMay) {
  profile::TriggerWiring& trigger = folder_->profile().wiring.trigger;
  trigger.kind = profile::TriggerKind::kLine;
  trigger.chip = "/dev/no-such-chip";
  trigger.line = "1";
  folder_->provision();
  const Start refused(folder_->path(), kSim);
  EXPECT_FALSE(refused.status.ok());
  EXPECT_EQ(refused.reason().find("trigger: "), 0U) << refused.reason();
  trigger.may_run_free = true;
  folder_->provision();
  Start start(folder_->path(), kSim);
  ASSERT_TRUE(start.status.ok()) << start.reason();
  face::Vitals vitals;
  start.machine.examine(vitals);
  EXPECT_EQ(vitals.trigger.view(), "free");
  EXPECT_EQ(std::string(vitals.trigger_trouble.view()), refused.reason() + ": cameras run free");
}

// A camera that is not there is no reason not to serve: it is looked for, the others are used.
TEST_F(BoardStart, CameraThatIsNotThere_IsLookedForWhileTheDeviceServes) {
  folder_->profile().cameras[1].wiring.driver = profile::ImageDriver::kV4l2;
  folder_->profile().cameras[1].wiring.key = "port:no-such-port";
  folder_->provision();
  Start start(folder_->path(), kSim);
  ASSERT_TRUE(start.status.ok()) << start.reason();
  start.clocks.sleep_until(start.clocks.now_ns() + 300'000'000);
  face::Vitals vitals;
  vitals.now_ns = start.clocks.now_ns();
  start.machine.examine(vitals);
  EXPECT_EQ(complaint(vitals.cameras[0], vitals.now_ns).view(), "");
  EXPECT_NE(std::string(complaint(vitals.cameras[1], vitals.now_ns).view()).find("cam1: not found"), std::string::npos);
}

TEST_F(BoardStart, LidarWhoseInterfaceIsMissing_IsLookedForWhileTheDeviceServes) {
  profile::LidarWiring& wiring = folder_->profile().lidars[0].wiring;
  wiring.driver = profile::PacketDriver::kUdp;
  wiring.group = "239.192.0.1";
  wiring.interface = "nothere0";
  folder_->provision();
  Start start(folder_->path(), kSim);
  ASSERT_TRUE(start.status.ok()) << start.reason();
  face::Vitals vitals;
  vitals.now_ns = start.clocks.now_ns();
  start.machine.examine(vitals);
  EXPECT_EQ(std::string(complaint(vitals.lidars[0], vitals.now_ns).view()).find("lidar0: its network interface"), 0U);
}

TEST_F(BoardStart, StoreOfAnotherDevice_IsNotUsed) {
  { ASSERT_TRUE(Start(folder_->path(), kSim).status.ok()); }
  folder_->profile().serial = "RB-0043";
  folder_->provision();
  Start start(folder_->path(), kSim);
  ASSERT_TRUE(start.status.ok()) << start.reason();
  EXPECT_EQ(start.machine.store()->state(), store::State::kUncalibrated);
  EXPECT_NE(std::string(start.machine.store()->diagnosis().view()).find("another device"), std::string::npos);
}

}  // namespace
}  // namespace roomcal::board
