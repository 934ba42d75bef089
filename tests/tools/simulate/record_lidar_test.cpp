#include "tools/simulate/record_lidar.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tools/common/error.h"
#include "tools/simulate/make_room.h"
#include "tools/sweep/load_sweeps.h"

namespace roomcal::tools {
namespace {

const Scene& room() {
  static const Scene scene = make_room({.seed = 9, .pillar = true});
  return scene;
}

TrueLidar lidar_of(const std::string& kind, std::size_t beams) {
  return {"lidar0", kind, {so3_exp(Vec3(0.6, -0.3, 0.9)), Vec3(1.2, 1.7, 1.1)}, 0, std::vector<double>(beams)};
}

Recording decode(const LidarRecording& recording, const TrueLidar& lidar) {
  LoadRequest request;
  request.model = lidar.kind;
  request.options.capacity = 1'000'000;
  return load_sweeps(recording.file, recording.bytes, request);
}

std::size_t whole_sweeps(const Recording& recording) {
  std::size_t count = 0;
  for (const LoadedSweep& sweep : recording.sweeps) count += sweep.facts.flags == 0 ? 1 : 0;
  return count;
}

/// Distance of a point to the nearest wall, from plane equations alone.
double off_walls_m(const Vec3& p_room) {
  double nearest = 1e9;
  for (const Plane& wall : room().walls) nearest = std::min(nearest, std::abs(wall.signed_distance(p_room)));
  for (const Body& body : room().bodies)
    for (const Plane& face : body.faces) nearest = std::min(nearest, std::abs(face.signed_distance(p_room)));
  return nearest;
}

TEST(RecordLidar, Vlp16_DecodesToWholeSweepsOnTheWalls) {
  const TrueLidar lidar = lidar_of("vlp16", 16);
  const LidarRecording made = record_lidar(EchoCaster(room()), lidar, {.sweeps = 3}, 5);
  const Recording recording = decode(made, lidar);
  EXPECT_TRUE(recording.report.warnings.empty());
  EXPECT_EQ(whole_sweeps(recording), 3U);
  std::size_t points = 0;
  for (const LoadedSweep& sweep : recording.sweeps) {
    for (std::size_t i = 0; i < sweep.points.size(); ++i, ++points) {
      // Half a unit of range, and an azimuth that is rounded to 0.01 degree, at 5 m and under a flat angle.
      ASSERT_LT(off_walls_m(lidar.T_room_lidar * sweep.view().position_lidar(i)), 0.0025);
    }
  }
  EXPECT_EQ(points, made.returns);
}

TEST(RecordLidar, BeamOffsets_AreInTheRanges) {
  TrueLidar lidar = lidar_of("vlp16", 16);
  const Recording plain = decode(record_lidar(EchoCaster(room()), lidar, {.sweeps = 1}, 5), lidar);
  for (std::size_t beam = 0; beam < 16; ++beam) lidar.beam_offset_m[beam] = 0.002 * static_cast<double>(beam) - 0.01;
  const Recording off = decode(record_lidar(EchoCaster(room()), lidar, {.sweeps = 1}, 5), lidar);
  ASSERT_EQ(plain.sweeps[0].points.size(), off.sweeps[0].points.size());
  for (std::size_t i = 0; i < plain.sweeps[0].points.size(); ++i) {
    const lidar::SweepPoint &a = plain.sweeps[0].points[i], &b = off.sweeps[0].points[i];
    ASSERT_NEAR(static_cast<double>(b.range_m - a.range_m), lidar.beam_offset_m[a.beam], 1e-5);
  }
}

TEST(RecordLidar, NoiseAndDropout_AreWhatWasAsked) {
  TrueLidar lidar = lidar_of("vlp16", 16);
  const LidarRecording quiet = record_lidar(EchoCaster(room()), lidar, {.sweeps = 2}, 5);
  EXPECT_EQ(quiet.returns, quiet.firings);
  const LidarRecording gaps = record_lidar(EchoCaster(room()), lidar, {.sweeps = 2, .dropout = 0.2}, 5);
  const auto share = static_cast<double>(gaps.returns) / static_cast<double>(gaps.firings);
  EXPECT_NEAR(share, 0.8, 4 * std::sqrt(0.16 / static_cast<double>(gaps.firings)));

  lidar.sigma_m = 0.02;
  const Recording noisy = decode(record_lidar(EchoCaster(room()), lidar, {.sweeps = 2}, 5), lidar);
  const Recording truth = decode(quiet, lidar);
  double squares = 0;
  const std::size_t count = truth.sweeps[0].points.size();
  for (std::size_t i = 0; i < count; ++i)
    squares += std::pow(static_cast<double>(noisy.sweeps[0].points[i].range_m - truth.sweeps[0].points[i].range_m), 2);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(count)), 0.02, 0.0005);
}

TEST(RecordLidar, MixedPixels_FloatBetweenSurfaces) {
  const TrueLidar lidar = lidar_of("vlp16", 16);
  const auto floating = [&](bool mixed_pixels) {
    LidarOptions options{.sweeps = 5};
    options.mixed_pixels = mixed_pixels;
    std::size_t count = 0;
    for (const LoadedSweep& sweep : decode(record_lidar(EchoCaster(room()), lidar, options, 5), lidar).sweeps)
      for (std::size_t i = 0; i < sweep.points.size(); ++i)
        count += off_walls_m(lidar.T_room_lidar * sweep.view().position_lidar(i)) > 0.02 ? 1U : 0U;
    return count;
  };
  EXPECT_EQ(floating(false), 0U);
  EXPECT_GT(floating(true), 5U);
  EXPECT_LT(floating(true), 500U);
}

TEST(RecordLidar, Tls_CoversTheSphereWithPointsOnTheWalls) {
  const TrueLidar lidar = lidar_of("tls", 1);
  const LidarRecording made = record_lidar(EchoCaster(room()), lidar, {.tls_step_rad = deg_to_rad(3)}, 5);
  EXPECT_EQ(made.file, "lidar0.pcd");
  const Recording recording = decode(made, lidar);
  ASSERT_EQ(recording.sweeps.size(), 1U);
  const lidar::Sweep sweep = recording.sweeps[0].view();
  ASSERT_EQ(sweep.points.size(), 60U * 120U);
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    const Vec3 p_room = lidar.T_room_lidar * sweep.position_lidar(i);
    ASSERT_LT(off_walls_m(p_room), 1e-5);
    const Vec3 along = sweep.position_lidar(i).normalized();
    low = low.cwiseMin(along);
    high = high.cwiseMax(along);
  }
  EXPECT_LT(low.maxCoeff(), -0.99);
  EXPECT_GT(high.minCoeff(), 0.99);
}

TEST(RecordLidar, SameSeed_SameBytes) {
  TrueLidar lidar = lidar_of("vlp16", 16);
  lidar.sigma_m = 0.015;
  const EchoCaster caster(room());
  EXPECT_EQ(record_lidar(caster, lidar, {.sweeps = 1}, 5).bytes, record_lidar(caster, lidar, {.sweeps = 1}, 5).bytes);
  EXPECT_NE(record_lidar(caster, lidar, {.sweeps = 1}, 5).bytes, record_lidar(caster, lidar, {.sweeps = 1}, 6).bytes);
}

TEST(RecordLidar, UnknownKind_SaysWhatThereIs) {
  EXPECT_THROW(record_lidar(EchoCaster(room()), lidar_of("sonar", 1), {}, 1), ToolError);
}

}  // namespace
}  // namespace roomcal::tools
