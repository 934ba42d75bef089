#include "tests/board/tls_bench.h"

#include <cmath>

#include <Eigen/Geometry>
#include <arpa/inet.h>
#include <sys/socket.h>

#include "board/tls/capacities.h"
#include "runtime/lidar/r2000.h"
#include "tests/runtime/lidar/packet_bytes.h"
#include "tools/simulate/ray.h"

namespace roomcal::board::test {

namespace {

constexpr uint8_t kNode = 5;
constexpr int64_t kMs = 1'000'000;
constexpr uint16_t kPort = 24'641;
constexpr int kRays = 720, kRaysPerPacket = 240;
constexpr int64_t kRay_ns = 20 * kMs / kRays;        // 50 turns a second
constexpr int64_t kSensorAhead_ns = 12'345'000'000;  // its clock is its own

/// The profiler's plane at table angle zero, as tools/simulate/tls_scan.h has it: x_p forward, y_p up.
lidar::TurntableMounting mounting() {
  lidar::TurntableMounting table;
  table.T_lidar_profiler.R << 0, 0, 1, 0, -1, 0, 1, 0, 0;
  return table;
}

}  // namespace

/// Packets of a profiler that stands in a room and is turned.
class TlsProfiler {
 public:
  TlsProfiler(const tools::Scene& scene, const SE3& T_room_lidar) : scene_(scene), T_room_lidar_(T_room_lidar) {
    socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    to_.sin_family = AF_INET;
    to_.sin_port = htons(kPort);
    to_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  }
  ~TlsProfiler() { ::close(socket_); }

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
class TlsWorld final : public drivers::Thread::Body {
 public:
  TlsWorld(CanSide& can, fakes::FakeServoDrive& drive, const BoardFolder& folder, double counts_per_turn)
      : can_(can),
        drive_(drive),
        profiler_(folder.scene(), folder.stand().lidars[0].T_room_lidar),
        counts_per_turn_(counts_per_turn) {}

  void run() override {
    if (on_begin) on_begin();
    for (int64_t next_ns = clocks_.now_ns(); !stop; next_ns += kMs) {
      clocks_.sleep_until(next_ns);
      drive_.tick();
      profiler_.fire(clocks_.now_ns(), 2 * kPi * drive_.position_counts() / counts_per_turn_);
      can_.poll();
    }
  }
  std::atomic<bool> stop{false};
  std::function<void()> on_begin;

 private:
  drivers::LinuxClocks clocks_;
  CanSide& can_;
  fakes::FakeServoDrive& drive_;
  TlsProfiler profiler_;
  double counts_per_turn_;
};

TlsBench::TlsBench(double half_turn_s, double haste, std::function<void()> in_world)
    : folder_("tls", 0.15, 340),
      log_(clocks_, true),
      bus_(clocks_),
      drive_(bus_, clocks_, kNode),
      can_(bus_, clocks_, log_) {
  bus_.attach(drive_);
  prepare(half_turn_s, haste);
  arm(std::move(in_world));
}

TlsBench::~TlsBench() {
  world_->stop = true;
  thread_.join();
}

void TlsBench::prepare(double half_turn_s, double haste) {
  folder_.render_pictures();
  profile::Profile& profile = folder_.profile();
  profile.lidars[0].on_turntable = true;
  profile.lidars[0].turntable = mounting();
  profile.lidars[0].wiring.driver = profile::PacketDriver::kUdp;
  profile.lidars[0].wiring.port = kPort;
  profile.lidars[0].wiring.sweeps = 1;
  profile.wiring.can.interface = "can0";
  profile.wiring.servo.node = kNode;
  profile.wiring.servo.half_turn_s = half_turn_s;
  profile.wiring.servo.acceleration_units_per_count = haste;
  profile.grab.patience_s = 60;
  folder_.provision();
}

void TlsBench::arm(std::function<void()> in_world) {
  const profile::Wiring& wiring = folder_.profile().wiring;
  machine_ = std::make_unique<Machine>(MachineOptions{.board = &kTls, .folder = {folder_.path()}}, clocks_, log_, can_);
  world_ = std::make_unique<TlsWorld>(can_, drive_, folder_, wiring.servo.counts_per_turn);
  world_->on_begin = std::move(in_world);
  if (const Status started = can_.start(wiring, 1); !started.ok()) trouble_ = Reason(started.detail());
  if (!trouble_.empty() || !machine_->plan(trouble_).ok() || !machine_->arm(trouble_).ok()) return;
  drivers::ThreadOptions real_time;
  real_time.fifo_priority = 10;  // a bus does not wait for a busy host
  if (const Status started = thread_.start(real_time, *world_); !started.ok()) trouble_ = Reason(started.detail());
}

const press::Report& TlsBench::press(press::Kind kind) {
  constexpr int64_t kPatience_ns = 90'000 * kMs;
  static_cast<void>(machine_->press_thread().start(kind));
  const int64_t begin_ns = clocks_.now_ns();
  while (machine_->press_thread().busy() && clocks_.now_ns() - begin_ns < kPatience_ns)
    clocks_.sleep_until(clocks_.now_ns() + 20 * kMs);
  return machine_->press()->report();
}

}  // namespace roomcal::board::test
