// A terrestrial scanner's sweep from end to end without hardware: a CiA 402 drive on a bus turns a 2-D profiler in a
// room, and the sweep is that room.

#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "runtime/lidar/turntable.h"
#include "tests/drivers/cia402/servo_bench.h"
#include "tools/simulate/make_room.h"
#include "tools/simulate/ray.h"

namespace roomcal {
namespace {

using drivers::cia402::ServoOptions;
using drivers::cia402::ServoPosition;
using drivers::cia402::ServoStep;
using drivers::cia402::test::kMs;
using drivers::cia402::test::ServoBench;

constexpr int kFiringsPerMs = 36;  // a profile of 720 points at 50 Hz
constexpr int kFiringsPerProfile = 720;
constexpr double kRate_radps = 0.5;

lidar::TurntableOptions table_options() {
  lidar::TurntableOptions options;
  options.mounting.T_lidar_profiler.R << 0, 0, 1, 0, -1, 0, 1, 0, 0;  // upright, looking forward
  options.mounting.T_lidar_profiler.R =
      options.mounting.T_lidar_profiler.R * Eigen::AngleAxisd(0.006, Vec3::UnitY()).toRotationMatrix();
  options.mounting.T_lidar_profiler.t = Vec3(0.031, 0.002, -0.008);
  options.capacity = 300'000;
  return options;
}

/// A profiler that fires while a drive turns it.
class Profiler {
 public:
  Profiler(const lidar::TurntableMounting& mounting, ServoBench& bench) : mounting_(mounting), bench_(bench) {
    tools::RoomOptions options;
    options.markers = 20;
    options.pillar = true;
    scene_ = tools::make_room(options);
    last_counts_ = bench.drive.position_counts();
  }

  // The firings of the last millisecond. The drive's path within it is straight to a tenth of a microradian.
  void fire() {
    const double counts = bench_.drive.position_counts();
    const int64_t begin_ns = bench_.clocks.read(ClockId::kRealtime).ns - kMs;
    for (int i = 0; i < kFiringsPerMs; ++i) {
      const double share = static_cast<double>(i) / kFiringsPerMs;
      const double angle = angle_of(bench_.options, last_counts_ + share * (counts - last_counts_));
      add(begin_ns + static_cast<int64_t>(share * kMs), angle);
    }
    last_counts_ = counts;
  }
  bool profile_done() const { return points_.size() == kFiringsPerProfile; }
  // @return whether the table took it
  bool hand_over(lidar::Turntable& table) {
    lidar::Sweep profile;
    profile.points = points_;
    profile.beam_count = 1;
    const bool taken = table.add_profile(profile, {first_ns_, ClockId::kRealtime}).ok();
    points_.clear();
    return taken;
  }
  const std::vector<Vec3>& truth() const { return truth_; }

 private:
  void add(int64_t ns, double angle_rad) {
    if (points_.empty()) first_ns_ = ns;
    const double azimuth = 2 * kPi * static_cast<double>(points_.size()) / kFiringsPerProfile;
    const SE3 T_lidar_profiler =
        SE3{Eigen::AngleAxisd(angle_rad, mounting_.axis_lidar).toRotationMatrix(), Vec3::Zero()} *
        mounting_.T_lidar_profiler;
    const Vec3 ray(std::cos(azimuth), std::sin(azimuth), 0);
    const double range_m = tools::cast_ray(scene_, kPlace_room + T_lidar_profiler.t, T_lidar_profiler.R * ray).distance;
    lidar::SweepPoint point;
    point.x_m = static_cast<float>(range_m * ray.x());
    point.y_m = static_cast<float>(range_m * ray.y());
    point.range_m = static_cast<float>(range_m);
    point.offset_ns = static_cast<int32_t>(ns - first_ns_);
    points_.push_back(point);
    truth_.push_back(T_lidar_profiler * Vec3(range_m * ray));
  }

  const Vec3 kPlace_room{1.4, 1.9, 1.2};
  lidar::TurntableMounting mounting_;
  ServoBench& bench_;
  tools::Scene scene_;
  double last_counts_ = 0;
  std::vector<lidar::SweepPoint> points_;
  int64_t first_ns_ = 0;
  std::vector<Vec3> truth_;
};

struct TlsSweep : testing::Test {
  TlsSweep() : memory(lidar::Turntable::arena_bytes(options)), arena(memory) {
    table = lidar::Turntable::create(options, arena).value();
    bench.before_each = [this] {
      bench.bus.send_delay_ns = std::uniform_int_distribution<int64_t>(0, 900'000)(random);
    };
  }

  // Turns until the sweep is whole, or so long. @param each  called every millisecond
  void scan(const std::function<void(int)>& each = [](int) {}) {
    ASSERT_TRUE(bench.reach_any(ServoStep::kReady));
    Profiler made(options.mounting, bench);
    bench.positions.clear();
    table.begin();
    ASSERT_TRUE(bench.servo.turn(kRate_radps).ok());
    first_fired_ns = bench.clocks.read(ClockId::kRealtime).ns;
    for (int ms = 0; ms < 12'000 && !table.whole() && bench.servo.step() == ServoStep::kTurn; ++ms) {
      bench.turn_once();
      made.fire();
      each(ms);
      for (const ServoPosition& at : bench.positions) ASSERT_TRUE(table.add_angle({at.on_bus, at.angle_rad}).ok());
      bench.positions.clear();
      if (made.profile_done()) {
        ASSERT_TRUE(made.hand_over(table));
      }
    }
    truth = made.truth();
    bench.servo.stop();
  }

  lidar::TurntableOptions options = table_options();
  std::vector<std::byte> memory;
  Arena arena;
  lidar::Turntable table;
  ServoBench bench;
  std::mt19937 random{11};
  int64_t first_fired_ns = 0;
  std::vector<Vec3> truth;
};

TEST_F(TlsSweep, DriveAndProfiler_GiveTheRoomToATenthOfAMillimetre) {
  scan();
  ASSERT_TRUE(table.whole());
  const lidar::Sweep& sweep = table.finish();
  EXPECT_EQ(sweep.flags, 0U);
  ASSERT_GT(sweep.points.size(), 220'000U);
  // Only those before the first SYNC and after the last one have no angle.
  const auto first = static_cast<std::size_t>((sweep.stamp.ns - first_fired_ns) / (kMs / kFiringsPerMs));
  double worst_m = 0;
  for (std::size_t i = 0; i < sweep.points.size(); ++i)
    worst_m = std::max(worst_m, (sweep.position_lidar(i) - truth[i + first]).norm());
  std::printf("%zu points, worst %.4f mm\n", sweep.points.size(), 1000 * worst_m);
  EXPECT_LT(worst_m, 1e-4);
}

TEST_F(TlsSweep, LostPositions_CostTheirPointsAndFlagTheSweep) {
  scan([&](int ms) { bench.drive.trouble.no_tpdo = ms >= 3'000 && ms < 3'100; });
  EXPECT_EQ(bench.servo.reason().view(), "");
  EXPECT_NE(table.finish().flags & lidar::kSweepAngleGap, 0U);
  EXPECT_NEAR(static_cast<double>(table.counters().without_angle), 100 * kFiringsPerMs, 30 * kFiringsPerMs);
}

TEST_F(TlsSweep, FollowingError_LeavesAPartialSweep) {
  scan([&](int ms) {
    if (ms == 2'000) bench.drive.break_down(0x8611);
  });
  EXPECT_EQ(bench.servo.fault().fault, drivers::cia402::ServoFault::kFollowingError);
  EXPECT_FALSE(table.whole());
  EXPECT_NE(table.finish().flags & lidar::kSweepPartial, 0U);
}

}  // namespace
}  // namespace roomcal
