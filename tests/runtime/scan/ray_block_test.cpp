#include "runtime/scan/ray_block.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/truth/random.h"

namespace roomcal::scan {
namespace {

lidar::SweepPoint point_at(float x, float y, float z, uint16_t beam) {
  lidar::SweepPoint point;
  point.x_m = x;
  point.y_m = y;
  point.z_m = z;
  point.beam = beam;
  point.reflectivity = static_cast<uint16_t>(10 * beam);
  return point;
}

std::vector<lidar::SweepPoint> random_points(std::size_t count, uint64_t seed) {
  truth::Random random(seed);
  std::vector<lidar::SweepPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 p = random.uniform(1, 9) * random.normals<3>().normalized();
    points.push_back(point_at(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()),
                              static_cast<uint16_t>(i % 100)));
  }
  return points;
}

std::vector<RayBlock> read(const SweepView& view, std::size_t stride) {
  std::vector<RayBlock> blocks;
  for_each_block(view, {}, stride, [&](const RayBlock& block) { blocks.push_back(block); });
  return blocks;
}

TEST(BlockReader, JoinedSweeps_EveryPointOnceAndInOrder) {
  const std::vector<lidar::SweepPoint> a = random_points(100, 1), b = random_points(29, 2), none;
  std::vector<lidar::Sweep> sweeps(3);
  sweeps[0].points = a;
  sweeps[1].points = none;
  sweeps[2].points = b;
  const std::vector<RayBlock> blocks = read({sweeps}, 1);
  ASSERT_EQ(blocks.size(), 3U);
  EXPECT_EQ(ray_count(blocks), 129U);
  for (std::size_t i = 0; i < 129; ++i) {
    const RayBlock& block = blocks[i / kBlockRays];
    const std::size_t k = i % kBlockRays;
    const lidar::SweepPoint& point = i < 100 ? a[i] : b[i - 100];
    const Vec3 p_lidar = static_cast<double>(block.range_m[k]) * block.direction_lidar(k);
    EXPECT_NEAR(block.direction_lidar(k).norm(), 1, 1e-6);
    EXPECT_NEAR(
        (p_lidar - Vec3(static_cast<double>(point.x_m), static_cast<double>(point.y_m), static_cast<double>(point.z_m)))
            .norm(),
        0, 2e-6);
    EXPECT_EQ(block.beam[k], point.beam);
    EXPECT_EQ(block.reflectivity[k], point.reflectivity);
  }
  EXPECT_EQ(blocks[2].count, 1U);
  EXPECT_EQ(blocks[2].x[1], 0);
  EXPECT_EQ(blocks[2].range_m[1], 0);
}

TEST(BlockReader, PointsThatCannotBeUsed_AreLeftOut) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
  const std::vector<lidar::SweepPoint> points = {
      point_at(1, 2, 3, 5),   point_at(kNan, 2, 3, 5),  point_at(1, kInf, 3, 5),  point_at(1, 2, -kInf, 5),
      point_at(0, 0, 0, 5),   point_at(0.1F, 0, 0, 5),  point_at(1e30F, 0, 0, 5), point_at(200, 0, 0, 5),
      point_at(1, 2, 3, 128), point_at(1, 2, 3, 65535), point_at(3, 2, 1, 127)};
  lidar::Sweep sweep;
  sweep.points = points;
  const std::vector<RayBlock> blocks = read({{&sweep, 1}}, 1);
  ASSERT_EQ(blocks.size(), 1U);
  ASSERT_EQ(blocks[0].count, 2U);
  EXPECT_EQ(blocks[0].beam[0], 5);
  EXPECT_EQ(blocks[0].beam[1], 127);
}

TEST(BlockReader, NoUsablePoint_HasNoBlock) {
  const std::vector<lidar::SweepPoint> points(500, point_at(0, 0, 0, 1));
  lidar::Sweep sweep;
  sweep.points = points;
  EXPECT_TRUE(read({{&sweep, 1}}, 1).empty());
  EXPECT_TRUE(read({}, 1).empty());
}

TEST(BlockReader, Stride_GoesOnFromSweepToSweep) {
  const std::vector<lidar::SweepPoint> points = random_points(1000, 3);
  std::vector<lidar::Sweep> sweeps(2);
  sweeps[0].points = std::span(points).first(331);
  sweeps[1].points = std::span(points).subspan(331);
  lidar::Sweep whole;
  whole.points = points;
  const std::vector<RayBlock> cut = read({sweeps}, 7), once = read({{&whole, 1}}, 7);
  ASSERT_EQ(cut.size(), once.size());
  EXPECT_EQ(ray_count(cut), 143U);
  for (std::size_t b = 0; b < cut.size(); ++b) EXPECT_EQ(cut[b].x, once[b].x);
}

TEST(RayBlock, Box_HoldsEveryDirection) {
  const std::vector<lidar::SweepPoint> points = random_points(640, 4);
  lidar::Sweep sweep;
  sweep.points = points;
  for (const RayBlock& block : read({{&sweep, 1}}, 1)) {
    for (std::size_t i = 0; i < block.count; ++i) {
      EXPECT_LE(std::abs(block.x[i] - block.middle[0]), block.reach[0]);
      EXPECT_LE(std::abs(block.y[i] - block.middle[1]), block.reach[1]);
      EXPECT_LE(std::abs(block.z[i] - block.middle[2]), block.reach[2]);
    }
  }
}

TEST(Samples, SweepsOfAnySize_SpreadOverTheWhole) {
  for (const std::size_t count : {1U, 63U, 192U, 193U, 3000U, 28800U, 300000U}) {
    const std::vector<lidar::SweepPoint> points = random_points(count, 5);
    lidar::Sweep sweep;
    sweep.points = points;
    std::vector<std::byte> bytes(Samples::bytes());
    Arena arena{bytes};
    Samples samples;
    ASSERT_TRUE(Samples::take({{&sweep, 1}}, {}, arena, samples).ok());
    for (const std::span<const RayBlock> sample : {samples.probe, samples.coarse, samples.fine}) {
      // A stride of 2 would see every second beam: it is 3.
      EXPECT_GE(ray_count(sample), std::min<std::size_t>(count, 60)) << count;
      const lidar::SweepPoint& last = points.back();
      double nearest = 1e9;  // the last ray is one of the last of the sweep
      for (std::size_t back = 0; back < std::min<std::size_t>(count, 2 * count / 60 + 1); ++back) {
        nearest = std::min<double>(nearest, std::abs(static_cast<double>((&last)[-static_cast<long>(back)].beam) -
                                                     sample.back().beam[sample.back().count - 1]));
      }
      EXPECT_EQ(nearest, 0) << count;
    }
  }
}

TEST(Samples, ArenaTooSmall_IsRefused) {
  std::vector<std::byte> bytes(Samples::bytes() / 2);
  Arena arena{bytes};
  Samples samples;
  EXPECT_EQ(Samples::take({}, {}, arena, samples).code(), StatusCode::kOutOfMemory);
}

}  // namespace
}  // namespace roomcal::scan
