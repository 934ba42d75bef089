// The terrestrial scanner as a device: a CiA 402 drive on the bus turns a profiler whose packets come by UDP, two still
// cameras, one press; the cameras find the room and the scanner's sweep is that room.

#include <atomic>
#include <cmath>
#include <thread>

#include <Eigen/Geometry>
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include "board/common/machine.h"
#include "board/tls/capacities.h"
#include "drivers/os/thread.h"
#include "runtime/lidar/r2000.h"
#include "tests/board/board_folder.h"
#include "tests/fakes/fake_can_bus.h"
#include "tests/fakes/fake_servo_drive.h"
#include "tests/runtime/lidar/packet_bytes.h"
#include "tools/simulate/ray.h"

namespace roomcal::board {
namespace {

constexpr uint8_t kNode = 5;
constexpr int64_t kMs = 1'000'000;
constexpr uint16_t kPort = 24'641;
constexpr int kRays = 720, kRaysPerPacket = 240;
constexpr int64_t kRay_ns = 20 * kMs / kRays;        // 50 turns a second
constexpr int64_t kSensorAhead_ns = 12'345'000'000;  // its clock is its own
constexpr double kHalfTurn_s = 4;

/// The profiler's plane at table angle zero, as tools/simulate/tls_scan.h has it: x_p forward, y_p up.
lidar::TurntableMounting mounting() {
  lidar::TurntableMounting table;
  table.T_lidar_profiler.R << 0, 0, 1, 0, -1, 0, 1, 0, 0;
  return table;
}

/// Packets of a profiler that stands in a room and is turned.
class Profiler {
 public:
  Profiler(const tools::Scene& scene, const SE3& T_room_lidar) : scene_(scene), T_room_lidar_(T_room_lidar) {
    socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    to_.sin_family = AF_INET;
    to_.sin_port = htons(kPort);
    to_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  }
  ~Profiler() { ::close(socket_); }

  /// Fires all that was due until `now_ns`; the table moved evenly since the last call.
  void fire(int64_t now_ns, double angle_rad) {
    if (last_ns_ == 0) {
      last_ns_ = next_ns_ = now_ns;
      last_rad_ = angle_rad;
    }
    for (; next_ns_ <= now_ns; next_ns_ += kRay_ns) {
      const double share =
          now_ns == last_ns_ ? 1 : static_cast<double>(next_ns_ - last_ns_) / static_cast<double>(now_ns - last_ns_);
      add(last_rad_ + share * (angle_rad - last_rad_));
    }
    last_ns_ = now_ns;
    last_rad_ = angle_rad;
  }

 private:
  void add(double table_rad) {
    if (count_ == 0) packet_ns_ = next_ns_;
    const double ray_rad = 2 * kPi * ray_ / kRays;
    const Mat33 R_lidar_profiler =
        Eigen::AngleAxisd(table_rad, Vec3::UnitY()).toRotationMatrix() * mounting().T_lidar_profiler.R;
    const Vec3 ray_lidar = R_lidar_profiler * Vec3(std::cos(ray_rad), std::sin(ray_rad), 0);
    ranges_mm_[count_++] = 1e3 * tools::cast_ray(scene_, T_room_lidar_.t, T_room_lidar_.R * ray_lidar).distance;
    ++ray_;
    if (count_ == kRaysPerPacket) send();
    if (ray_ == kRays) {
      ray_ = 0;
      ++profile_;
    }
  }
  void send() {
    lidar::test::PacketBytes packet(lidar::kR2000HeadBytes + 4 * kRaysPerPacket);
    const int64_t stamp_ns = packet_ns_ + kSensorAhead_ns;
    packet.le(0, 0xA25C, 2);
    packet.le(2, 'C', 2);
    packet.le(4, packet.view().size(), 4);
    packet.le(8, lidar::kR2000HeadBytes, 2);
    packet.le(10, profile_, 2);
    packet.le(12, packet_++, 2);
    packet.le(14,
              static_cast<uint64_t>(stamp_ns / 1'000'000'000) << 32 |
                  (static_cast<uint64_t>(stamp_ns % 1'000'000'000) << 32) / 1'000'000'000,
              8);
    packet.le(34, 50'000, 4);
    packet.le(38, kRays, 2);
    packet.le(40, kRaysPerPacket, 2);
    packet.le(42, static_cast<uint64_t>(ray_ - kRaysPerPacket), 2);
    packet.le(44, static_cast<uint64_t>(3'600'000 / kRays * (ray_ - kRaysPerPacket)), 4);
    packet.le(48, 3'600'000 / kRays, 4);
    for (int i = 0; i < kRaysPerPacket; ++i)
      packet.le(lidar::kR2000HeadBytes + 4 * static_cast<std::size_t>(i),
                static_cast<uint64_t>(std::lround(ranges_mm_[static_cast<std::size_t>(i)])) | 100U << 20, 4);
    const lidar::Bytes bytes = packet.view();
    static_cast<void>(
        ::sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to_), sizeof to_));
    count_ = 0;
  }

  const tools::Scene& scene_;
  SE3 T_room_lidar_;
  int socket_ = -1;
  sockaddr_in to_{};
  int64_t last_ns_ = 0, next_ns_ = 0, packet_ns_ = 0;
  double last_rad_ = 0;
  std::array<double, kRaysPerPacket> ranges_mm_{};
  int count_ = 0, ray_ = 0;
  uint64_t profile_ = 0, packet_ = 0;
};

/// The bus, the drive on it and what it turns, at a kilohertz; also the supervisor's part, which owns the bus.
class World final : public drivers::Thread::Body {
 public:
  World(CanSide& can, fakes::FakeServoDrive& drive, Profiler& profiler, double counts_per_turn)
      : can_(can), drive_(drive), profiler_(profiler), counts_per_turn_(counts_per_turn) {}

  void run() override {
    for (int64_t next_ns = clocks_.now_ns(); !stop; next_ns += kMs) {
      clocks_.sleep_until(next_ns);
      drive_.tick();
      profiler_.fire(clocks_.now_ns(), 2 * kPi * drive_.position_counts() / counts_per_turn_);
      can_.poll();
    }
  }
  std::atomic<bool> stop{false};

 private:
  drivers::LinuxClocks clocks_;
  CanSide& can_;
  fakes::FakeServoDrive& drive_;
  Profiler& profiler_;
  double counts_per_turn_;
};

TEST(TlsBoard, OnePress_FindsScannerAndCameras) {
  test::BoardFolder folder("tls", 0.15, 340);
  folder.render_pictures();
  profile::Profile& profile = folder.profile();
  profile.lidars[0].on_turntable = true;
  profile.lidars[0].turntable = mounting();
  profile.lidars[0].wiring.driver = profile::PacketDriver::kUdp;
  profile.lidars[0].wiring.port = kPort;
  profile.lidars[0].wiring.sweeps = 1;
  profile.wiring.can.interface = "can0";
  profile.wiring.servo.node = kNode;
  profile.wiring.servo.half_turn_s = kHalfTurn_s;
  profile.grab.patience_s = 60;
  folder.provision();

  drivers::LinuxClocks clocks;
  EventLog log(clocks, true);
  fakes::FakeCanBus bus(clocks);
  fakes::FakeServoDrive drive(bus, clocks, kNode);
  bus.attach(drive);
  CanSide can(bus, clocks, log);
  ASSERT_TRUE(can.start(profile.wiring, 1).ok());
  Machine machine({.board = &kTls, .folder = {folder.path()}}, clocks, log, can);
  Reason why;
  ASSERT_TRUE(machine.plan(why).ok()) << why.view();
  ASSERT_TRUE(machine.arm(why).ok()) << why.view();

  const SE3& T_room_lidar = folder.stand().lidars[0].T_room_lidar;
  Profiler profiler(folder.scene(), T_room_lidar);
  World world(can, drive, profiler, profile.wiring.servo.counts_per_turn);
  drivers::Thread thread;
  drivers::ThreadOptions real_time;
  real_time.fifo_priority = 10;  // a bus does not wait for a busy host
  ASSERT_TRUE(thread.start(real_time, world).ok());

  ASSERT_TRUE(machine.press_thread().start(press::Kind::kCalibrate));
  const int64_t begin_ns = clocks.now_ns();
  while (machine.press_thread().busy() && clocks.now_ns() - begin_ns < 90'000 * kMs)
    clocks.sleep_until(clocks.now_ns() + 20 * kMs);
  world.stop = true;
  thread.join();
  const press::Report& report = machine.press()->report();
  for (const Reason& reason : report.reasons) std::printf("%s\n", std::string(reason.view()).c_str());
  ASSERT_TRUE(machine.press()->has_outcome());
  EXPECT_TRUE(report.stored) << to_string(report.result);
  const calib::Outcome& outcome = machine.press()->outcome();
  ASSERT_TRUE(outcome.lidars[0].in_rig) << outcome.lidars[0].failure.view();
  EXPECT_GT(outcome.lidars[0].location.points, 100'000U);
  const SE3 T_cam_lidar = folder.stand().cameras[0].T_room_cam.inverse() * T_room_lidar;
  const Vec6 error = se3_log(outcome.lidars[0].T_rig_lidar.inverse() * T_cam_lidar);
  std::printf("TLS: camera to scanner %.2f mm, %.4f deg from the truth\n", 1e3 * error.head<3>().norm(),
              rad_to_deg(error.tail<3>().norm()));
  EXPECT_LT(error.head<3>().norm(), 0.003);
  EXPECT_LT(rad_to_deg(error.tail<3>().norm()), 0.05);
}

}  // namespace
}  // namespace roomcal::board
