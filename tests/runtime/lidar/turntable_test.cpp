#include "runtime/lidar/turntable.h"

#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "runtime/lidar/r2000.h"
#include "runtime/lidar/sweep_builder.h"
#include "tests/runtime/lidar/packet_bytes.h"
#include "tools/simulate/make_room.h"
#include "tools/simulate/ray.h"

namespace roomcal::lidar {
namespace {

using test::PacketBytes;

constexpr int64_t kMs = 1'000'000;
constexpr ClockId kClock = ClockId::kRealtime;

// The true table: from rest with 0.8 rad/s^2 to 0.35 rad/s, and on.
double true_angle_rad(double s) {
  constexpr double kRate = 0.35, kRamp = 0.8, kRampTime = kRate / kRamp;
  if (s <= 0) return 0.2;
  return 0.2 + (s < kRampTime ? 0.5 * kRamp * s * s : kRate * (s - 0.5 * kRampTime));
}

// 23 mm off the axis, tilted by half a degree, zero somewhere.
TurntableMounting some_mounting() {
  TurntableMounting mounting;
  mounting.axis_lidar = Vec3(0.01, -1, 0.02).normalized();
  mounting.T_lidar_profiler.R =
      (Eigen::AngleAxisd(0.4, Vec3::UnitY()) * Eigen::AngleAxisd(deg_to_rad(90.5), Vec3::UnitX())).toRotationMatrix();
  mounting.T_lidar_profiler.t = Vec3(0.023, -0.004, 0.011);
  return mounting;
}

/// A profiler on its turntable in a room with a pillar, all by ray casting and quaternions.
class World {
 public:
  explicit World(const TurntableMounting& mounting) : mounting_(mounting) {
    tools::RoomOptions options;
    options.seed = 5;
    options.markers = 20;
    options.pillar = true;
    scene_ = tools::make_room(options);
    T_room_lidar_.R = Eigen::AngleAxisd(0.7, Vec3(0.2, 0.1, 1).normalized()).toRotationMatrix();
    T_room_lidar_.t = Vec3(1.3, 1.7, 1.1);
  }

  SE3 T_lidar_profiler(double s) const {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(true_angle_rad(s), mounting_.axis_lidar));
    return SE3{turn.toRotationMatrix(), Vec3::Zero()} * mounting_.T_lidar_profiler;
  }
  static Vec3 ray_profiler(double azimuth_rad) { return {std::cos(azimuth_rad), std::sin(azimuth_rad), 0}; }
  double range_m(double s, double azimuth_rad) const {
    const SE3 T_room_profiler = T_room_lidar_ * T_lidar_profiler(s);
    return tools::cast_ray(scene_, T_room_profiler.t, T_room_profiler.R * ray_profiler(azimuth_rad)).distance;
  }
  Vec3 point_lidar(double s, double azimuth_rad, double range_m) const {
    return T_lidar_profiler(s) * Vec3(range_m * ray_profiler(azimuth_rad));
  }
  // How far a point is in front of or behind what the lidar's own ray to it meets.
  double off_surface_m(const Vec3& point_lidar) const {
    const Vec3 along = T_room_lidar_.R * point_lidar.normalized();
    return tools::cast_ray(scene_, T_room_lidar_.t, along).distance - point_lidar.norm();
  }

 private:
  TurntableMounting mounting_;
  tools::Scene scene_;
  SE3 T_room_lidar_;
};

struct Memory {
  explicit Memory(const TurntableOptions& options) : bytes(Turntable::arena_bytes(options)), arena(bytes) {}
  std::vector<std::byte> bytes;
  Arena arena;
};

constexpr double kFirst_s = 100;  // of the clock, when the table begins to move

StampedAngle angle_at(double s) {
  return {{static_cast<int64_t>(std::llround((kFirst_s + s) * 1e9)), kClock}, true_angle_rad(s)};
}

struct TurntableTest : testing::Test {
  explicit TurntableTest(const TurntableOptions& with = {}) : options(with), memory(options) {
    table = Turntable::create(options, memory.arena).value();
    table.begin();
  }
  // `count` points one after the other, all 2 m away, from time s on.
  Status profile(double s, std::size_t count, double spacing_s = 1e-5) {
    std::vector<SweepPoint> points(count);
    for (std::size_t i = 0; i < count; ++i) {
      points[i].x_m = points[i].range_m = 2;
      points[i].offset_ns = static_cast<int32_t>(std::lround(static_cast<double>(i) * spacing_s * 1e9));
      points[i].reflectivity = static_cast<uint16_t>(i);
    }
    Sweep sweep;
    sweep.points = points;
    sweep.beam_count = 1;
    sweep.packets = 1;
    sweep.flags = profile_flags;
    return table.add_profile(sweep, angle_at(s).stamp);
  }
  void expect_sums() const {
    const TurntableCounters& c = table.counters();
    EXPECT_EQ(c.offered, c.kept + c.thinned + c.without_angle + c.crowded_out + c.not_finite + c.beyond);
  }

  TurntableOptions options;
  Memory memory;
  Turntable table;
  uint32_t profile_flags = 0;
};

// The truth of the whole path: ray-cast packets of a real protocol, its decoder, SYNC-stamped angles, the sweep.
TEST(Turntable, PacketsOfATurnInARoom_GiveThePointsOfTheRoom) {
  constexpr int kPerTurn = 720;
  constexpr double kTurn_s = 0.02;
  TurntableOptions options;
  options.mounting = some_mounting();
  options.capacity = 400'000;
  const World world(options.mounting);
  Memory memory(options);
  Turntable table = Turntable::create(options, memory.arena).value();
  const Calibration calibration = built_in_calibration(Model::kR2000).value();
  std::vector<std::byte> builder_bytes(SweepBuilder::arena_bytes({}));
  Arena builder_arena(builder_bytes);
  SweepBuilder builder = SweepBuilder::create(calibration, {}, builder_arena).value();
  table.begin();
  std::vector<Vec3> truth;
  int next_angle = 0, late = 0;
  for (int turn = 0; !table.whole() && turn < 1'000; ++turn) {
    const double begun_s = turn * kTurn_s;
    PacketBytes packet(kR2000HeadBytes + kPerTurn * 4);
    packet.le(0, 0xA25C, 2);
    packet.le(2, 'A', 2);
    packet.le(4, kR2000HeadBytes + kPerTurn * 4, 4);
    packet.le(8, kR2000HeadBytes, 2);
    packet.le(10, static_cast<uint64_t>(turn), 2);
    const auto sensor_ns = static_cast<uint64_t>(std::llround(begun_s * 1e9));  // its own clock begins at zero
    packet.le(14, sensor_ns / 1'000'000'000 << 32 | ((sensor_ns % 1'000'000'000) << 32) / 1'000'000'000, 8);
    packet.le(34, 50'000, 4);
    packet.le(38, kPerTurn, 2);
    packet.le(40, kPerTurn, 2);
    packet.le(44, static_cast<uint64_t>(-1'800'000), 4);
    packet.le(48, 5'000, 4);
    for (int i = 0; i < kPerTurn; ++i) {
      const double s = begun_s + kTurn_s * i / kPerTurn, azimuth = deg_to_rad(-180 + 0.5 * i);
      const double range_mm = std::round(1000 * world.range_m(s, azimuth));
      packet.le(kR2000HeadBytes + static_cast<std::size_t>(i) * 4, static_cast<uint64_t>(range_mm), 4);
      truth.push_back(world.point_lidar(s, azimuth, 0.001 * range_mm));
    }
    ASSERT_TRUE(builder.push(packet.view()).ok());
    if (builder.ready()) {
      Stamp stamp = builder.sweep().stamp;
      stamp = {stamp.ns + static_cast<int64_t>(kFirst_s * 1e9), kClock};
      ASSERT_TRUE(table.add_profile(builder.sweep(), stamp).ok());
    }
    // Positions come at 100 Hz, now before, now after the points that they belong to.
    late = (late + 1) % 4;
    for (; next_angle * 0.01 < begun_s + 0.01 * late; ++next_angle)
      ASSERT_TRUE(table.add_angle(angle_at(next_angle * 0.01)).ok());
  }
  ASSERT_TRUE(table.whole());
  const Sweep& sweep = table.finish();
  EXPECT_EQ(sweep.flags, 0U);
  EXPECT_EQ(table.stride(), 1U);
  ASSERT_GT(sweep.points.size(), 300'000U);
  double worst_m = 0;
  std::size_t off_surface = 0;
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    worst_m = std::max(worst_m, (sweep.position_lidar(i) - truth[i]).norm());
    off_surface += std::abs(world.off_surface_m(sweep.position_lidar(i))) > 0.0035;
  }
  EXPECT_LT(worst_m, 1e-4);
  // A millimetre of range by the protocol is more where a ray grazes; a few at edges see past them from the axis.
  EXPECT_LT(off_surface, sweep.points.size() / 500);
  std::printf("%zu points, worst %.4f mm\n", sweep.points.size(), 1000 * worst_m);
}

TEST(Turntable, SweepOfHalfATurn_CoversTheSphere) {
  TurntableOptions options;
  Memory memory(options);
  Turntable table = Turntable::create(options, memory.arena).value();
  table.begin();
  std::vector<SweepPoint> points(360);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double azimuth = deg_to_rad(static_cast<double>(i));
    points[i].x_m = static_cast<float>(std::cos(azimuth));
    points[i].y_m = static_cast<float>(std::sin(azimuth));
  }
  Sweep profile;
  profile.points = points;
  for (int i = 0; !table.whole(); ++i) {
    ASSERT_TRUE(table.add_angle({{i * 10 * kMs, kClock}, i * 0.01}).ok());
    ASSERT_TRUE(table.add_profile(profile, {i * 10 * kMs, kClock}).ok());
  }
  const Sweep& sweep = table.finish();
  EXPECT_EQ(sweep.flags, 0U);
  // Every direction of a grid over the sphere has a point within two degrees.
  for (double elevation = -85; elevation <= 85; elevation += 10)
    for (double azimuth = 0; azimuth < 360; azimuth += 10) {
      const double e = deg_to_rad(elevation), a = deg_to_rad(azimuth);
      const Vec3 wanted(std::cos(e) * std::sin(a), std::sin(e), std::cos(e) * std::cos(a));
      double best = -1;
      for (std::size_t i = 0; i < sweep.points.size(); ++i) best = std::max(best, wanted.dot(sweep.position_lidar(i)));
      ASSERT_GT(best, std::cos(deg_to_rad(2))) << elevation << " " << azimuth;
    }
}

TEST_F(TurntableTest, PointsBetweenTwoAngles_AreInterpolatedOnly) {
  EXPECT_TRUE(table.add_angle(angle_at(1.00)).ok());
  EXPECT_TRUE(profile(0.995, 2, 0.01).ok());  // one before the first angle, one after it
  EXPECT_EQ(table.counters().kept, 0U);
  EXPECT_TRUE(table.add_angle(angle_at(1.01)).ok());
  EXPECT_EQ(table.counters().kept, 1U);
  EXPECT_TRUE(profile(1.02, 1).ok());
  const Sweep& sweep = table.finish();
  ASSERT_EQ(sweep.points.size(), 1U);
  const double angle = 0.5 * (angle_at(1.00).angle_rad + angle_at(1.01).angle_rad);
  EXPECT_NEAR(sweep.position_lidar(0).x(), 2 * std::cos(angle), 1e-6);
  EXPECT_NEAR(sweep.position_lidar(0).z(), -2 * std::sin(angle), 1e-6);
  EXPECT_EQ(sweep.flags, static_cast<uint32_t>(kSweepPartial)) << "nothing is missing but the rest of the turn";
  EXPECT_EQ(table.counters().without_angle, 2U);
  expect_sums();
}

TEST_F(TurntableTest, TooLongBetweenTwoAngles_DropsThePointsAndFlags) {
  for (const double s : {1.00, 1.01, 1.05, 1.06}) EXPECT_TRUE(table.add_angle(angle_at(s)).ok());
  EXPECT_TRUE(profile(1.002, 500, 1e-4).ok());
  const Sweep& sweep = table.finish();
  EXPECT_EQ(table.counters().gaps, 1U);
  EXPECT_NEAR(static_cast<double>(table.counters().without_angle), 400, 2);
  EXPECT_EQ(sweep.points.size(), table.counters().kept);
  EXPECT_NE(sweep.flags & kSweepAngleGap, 0U);
  expect_sums();
}

TEST_F(TurntableTest, JumpOfTheAngle_DropsThePointsAndFlags) {
  EXPECT_TRUE(table.add_angle({{0, kClock}, 1.0}).ok());
  EXPECT_TRUE(table.add_angle({{10 * kMs, kClock}, 1.01}).ok());
  EXPECT_TRUE(table.add_angle({{20 * kMs, kClock}, 1.20}).ok());
  std::vector<SweepPoint> points(2);
  points[1].offset_ns = 15 * kMs;
  Sweep two;
  two.points = points;
  EXPECT_TRUE(table.add_profile(two, {0, kClock}).ok());
  EXPECT_NE(table.finish().flags & kSweepAngleGap, 0U);
  EXPECT_EQ(table.counters().kept, 1U);
}

TEST_F(TurntableTest, ClockThatWasSet_DropsWhatWaitsAndFlags) {
  EXPECT_TRUE(table.add_angle(angle_at(1.00)).ok());
  EXPECT_TRUE(profile(1.005, 10).ok());
  EXPECT_TRUE(table.add_angle(angle_at(0.50)).ok());
  EXPECT_EQ(table.counters().clock_jumps, 1U);
  EXPECT_EQ(table.counters().without_angle, 10U);
  EXPECT_TRUE(table.add_angle(angle_at(0.51)).ok());
  EXPECT_TRUE(profile(0.505, 10).ok());
  EXPECT_EQ(table.counters().kept, 10U);
  EXPECT_NE(table.finish().flags & kSweepAngleGap, 0U);
  expect_sums();
}

TEST_F(TurntableTest, ProfilesThatComeLate_FindTheirAngles) {
  for (int i = 0; i <= 900; ++i) EXPECT_TRUE(table.add_angle(angle_at(0.01 * i)).ok());
  EXPECT_TRUE(profile(0.5, 100).ok());
  EXPECT_TRUE(profile(8.5, 100).ok());
  EXPECT_EQ(table.counters().kept, 200U);
  for (int i = 901; i <= 2'000; ++i) EXPECT_TRUE(table.add_angle(angle_at(0.01 * i)).ok());
  EXPECT_TRUE(profile(0.6, 100).ok());
  EXPECT_EQ(table.counters().without_angle, 100U) << "forgotten after ten seconds";
}

TEST_F(TurntableTest, FlagsAndLossesOfProfiles_AreTheSweeps) {
  profile_flags = kSweepLostPackets | kSweepPartial;
  EXPECT_TRUE(table.add_angle({{0, kClock}, 0}).ok());
  EXPECT_TRUE(profile(1, 1).ok());
  EXPECT_EQ(table.finish().flags & (kSweepLostPackets | kSweepOtherSensor), kSweepLostPackets);
}

TEST_F(TurntableTest, StampsOfDifferentClocks_AreRefused) {
  EXPECT_EQ(table.add_angle({{1, ClockId::kUnknown}, 0}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(table.add_angle({{int64_t{1} << 62, kClock}, 0}).code(), StatusCode::kInvalidArgument);
  EXPECT_TRUE(table.add_angle({{1, ClockId::kMonotonic}, 0}).ok());
  EXPECT_EQ(table.add_angle({{2, kClock}, 0}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(profile(1, 1).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(table.counters().angles, 1U);
  EXPECT_EQ(table.counters().offered, 0U);
}

TEST_F(TurntableTest, NumbersThatAreNone_AreRefusedOrCounted) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(table.add_angle({{1, kClock}, nan}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(table.add_angle({{1, kClock}, 1e300}).code(), StatusCode::kInvalidArgument);
  std::vector<SweepPoint> points(3);
  points[0].x_m = std::numeric_limits<float>::quiet_NaN();
  points[1].z_m = std::numeric_limits<float>::infinity();
  Sweep sweep;
  sweep.points = points;
  EXPECT_TRUE(table.add_profile(sweep, {1, kClock}).ok());
  EXPECT_EQ(table.counters().not_finite, 2U);
}

TEST(Turntable, MorePointsThanRoom_AreThinnedEvenlyAndSaid) {
  for (const std::size_t capacity : {1'000U, 999U, 1U}) {
    TurntableOptions options;
    options.capacity = capacity;
    Memory memory(options);
    Turntable table = Turntable::create(options, memory.arena).value();
    table.begin();
    std::vector<SweepPoint> points(100);
    Sweep profile;
    profile.points = points;
    uint16_t number = 0;
    for (int i = 0; i < 100; ++i) {
      ASSERT_TRUE(table.add_angle({{i * 10 * kMs, kClock}, i * 0.01}).ok());
      for (std::size_t k = 0; k < points.size(); ++k) {
        points[k].reflectivity = number++;
        points[k].offset_ns = static_cast<int32_t>(k);
      }
      ASSERT_TRUE(table.add_profile(profile, {i * 10 * kMs + 1, kClock}).ok());
    }
    const Sweep& sweep = table.finish();
    const uint32_t stride = table.stride();
    EXPECT_LE(sweep.points.size(), capacity);
    EXPECT_GE(sweep.points.size(), (9'900 + stride - 1) / stride);
    EXPECT_GT(2 * sweep.points.size(), capacity) << "no more was left out than had to be";
    for (std::size_t i = 0; i < sweep.points.size(); ++i)
      ASSERT_EQ(sweep.points[i].reflectivity, static_cast<uint16_t>(i * stride));
    EXPECT_EQ(sweep.flags & kSweepFull, 0U);
    const TurntableCounters& c = table.counters();
    EXPECT_EQ(c.offered, c.kept + c.thinned + c.without_angle);
  }
}

TEST(Turntable, TooManyPointsWithoutAnAngle_AreCrowdedOut) {
  TurntableOptions options;
  options.waiting = 10;
  Memory memory(options);
  Turntable table = Turntable::create(options, memory.arena).value();
  table.begin();
  const std::vector<SweepPoint> points(25);
  Sweep profile;
  profile.points = points;
  EXPECT_TRUE(table.add_profile(profile, {0, kClock}).ok());
  EXPECT_EQ(table.counters().crowded_out, 15U);
  EXPECT_NE(table.finish().flags & kSweepAngleGap, 0U);
}

TEST(Turntable, BeyondTheSweep_IsLeftOutAndBeginStartsAnew) {
  TurntableOptions options;
  options.sweep_rad = 0.5;
  Memory memory(options);
  Turntable table = Turntable::create(options, memory.arena).value();
  for (int round = 0; round < 2; ++round) {
    table.begin();
    const std::vector<SweepPoint> one(1);
    Sweep profile;
    profile.points = one;
    for (int i = 0; i < 100; ++i) {
      ASSERT_TRUE(table.add_angle({{i * 10 * kMs, kClock}, -0.01 * i}).ok());
      ASSERT_TRUE(table.add_profile(profile, {i * 10 * kMs, kClock}).ok());
    }
    EXPECT_TRUE(table.whole());
    EXPECT_EQ(table.finish().flags, 0U);
    EXPECT_NEAR(static_cast<double>(table.counters().kept), 51, 1);
    EXPECT_NEAR(static_cast<double>(table.counters().beyond), 49, 1);
    EXPECT_EQ(table.finish().stamp, (Stamp{0, kClock}));
    EXPECT_NEAR(static_cast<double>(table.finish().duration_ns), 500e6, 11e6);
  }
}

TEST(Turntable, NothingAtAll_IsAPartialSweep) {
  Memory memory({});
  Turntable table = Turntable::create({}, memory.arena).value();
  table.begin();
  const Sweep& sweep = table.finish();
  EXPECT_TRUE(sweep.points.empty());
  EXPECT_NE(sweep.flags & kSweepPartial, 0U);
}

TEST(Turntable, BadOptionsAndLittleMemory_AreRefused) {
  Memory memory({});
  const auto code = [&](const auto& change) {
    TurntableOptions options;
    change(options);
    return Turntable::create(options, memory.arena).status().code();
  };
  using O = TurntableOptions;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code([](O& o) { o.mounting.axis_lidar = Vec3(0, 2, 0); }), StatusCode::kInvalidArgument);
  EXPECT_EQ(code([&](O& o) { o.mounting.axis_lidar.x() = nan; }), StatusCode::kInvalidArgument);
  EXPECT_EQ(code([](O& o) { o.mounting.T_lidar_profiler.R *= -1; }), StatusCode::kInvalidArgument);
  EXPECT_EQ(code([&](O& o) { o.mounting.T_lidar_profiler.t.y() = nan; }), StatusCode::kInvalidArgument);
  EXPECT_EQ(code([](O& o) { o.capacity = 0; }), StatusCode::kInvalidArgument);
  EXPECT_EQ(code([](O& o) { o.waiting = 0; }), StatusCode::kInvalidArgument);
  EXPECT_EQ(code([](O& o) { o.angles = 1; }), StatusCode::kInvalidArgument);
  EXPECT_EQ(code([](O& o) { o.max_gap_ns = 0; }), StatusCode::kInvalidArgument);
  EXPECT_EQ(code([&](O& o) { o.sweep_rad = nan; }), StatusCode::kInvalidArgument);
  EXPECT_EQ(code([](O& o) { o.capacity = 2'000'000; }), StatusCode::kOutOfMemory);
}

}  // namespace
}  // namespace roomcal::lidar
