#include "runtime/lidar/hesai.h"

#include <cmath>

#include <gtest/gtest.h>

#include "runtime/lidar/hesai_timing.h"
#include "runtime/lidar/utc.h"
#include "tests/runtime/lidar/packet_bytes.h"

namespace roomcal::lidar {
namespace {

using test::decode;
using test::Decoded;
using test::PacketBytes;
using test::some_calibration;

/// Sizes and places by the manuals, written down a second time.
struct Shape {
  Model model;
  std::size_t size, head, blocks, lasers, unit, block_head, tail, mode, date, us;
  int year_zero;
  uint8_t factory_at;
};
const Shape kShapes[] = {
    {Model::kXt16, 568, 12, 8, 16, 4, 2, 540, 10, 13, 19, 1900, 23},
    {Model::kXt32, 1080, 12, 8, 32, 4, 2, 1052, 10, 13, 19, 1900, 23},
    {Model::kXt32m, 820, 12, 6, 32, 4, 2, 792, 10, 13, 19, 1900, 23},
    {Model::kQt64, 1072, 12, 4, 64, 4, 2, 1044, 16, 18, 12, 1900, 17},
    {Model::kQt128, 1127, 12, 2, 128, 4, 2, 1061, 12, 15, 21, 1900, 25},
    {Model::kPandar40p, 1262, 0, 10, 40, 3, 4, 1240, 14, 16, 10, 2000, 15},
    {Model::kPandar64, 1194, 8, 6, 64, 3, 2, 1172, 14, 16, 10, 2000, 15},
};

std::size_t unit_at(const Shape& s, std::size_t block, std::size_t laser) {
  return s.head + block * (s.block_head + s.lasers * s.unit) + s.block_head + laser * s.unit;
}

PacketBytes packet(const Shape& s, uint8_t mode, std::size_t returns) {
  PacketBytes bytes(s.size);
  if (s.head > 0) bytes.be(0, 0xEEFF, 2);
  if (s.head == 12) {
    bytes.le(6, s.lasers, 1);
    bytes.le(7, s.blocks, 1);
    bytes.le(9, 4, 1);
  } else if (s.head == 8) {
    bytes.le(2, s.lasers, 1);
    bytes.le(3, s.blocks, 1);
    bytes.le(5, 4, 1);
  }
  for (std::size_t block = 0; block < s.blocks; ++block) {
    if (s.block_head == 4) bytes.be(unit_at(s, block, 0) - 4, 0xFFEE, 2);
    bytes.le(unit_at(s, block, 0) - 2, 9000 + 20 * (block / returns), 2);
    for (std::size_t laser = 0; laser < s.lasers; ++laser) {
      bytes.le(unit_at(s, block, laser), 1250 + 250 * (block % returns), 2);  // 5 m, 6 m, 7 m
      bytes.le(unit_at(s, block, laser) + 2, 50 + block % returns, 1);
    }
  }
  bytes.le(s.tail + s.mode, mode, 1);
  bytes.le(s.tail + s.date, static_cast<uint64_t>(2024 - s.year_zero), 1);
  bytes.le(s.tail + s.date + 1, 2, 1);
  bytes.le(s.tail + s.date + 2, 29, 1);
  bytes.le(s.tail + s.us, 500'000, 4);
  bytes.le(s.tail + s.factory_at, 0x42, 1);
  return bytes;
}

TEST(Hesai, EveryModelSingleReturn_GivesEveryUnitAtItsPlace) {
  for (const Shape& s : kShapes) {
    const Calibration calibration = some_calibration(s.model);
    const Decoded got = decode(calibration, packet(s, 0x37, 1).view());
    ASSERT_TRUE(got.status.ok()) << info(s.model).name << ": " << got.status.detail();
    ASSERT_EQ(got.points.size(), s.blocks * s.lasers) << info(s.model).name;
    EXPECT_FALSE(got.header.other_sensor);
    EXPECT_NEAR(static_cast<double>(got.header.stamp_ns),
                1e9 * static_cast<double>(utc_seconds(2024, 2, 29, 0, 0, 0)) + 5e8, 1e6);
    const std::size_t laser = s.lasers - 3;
    const SweepPoint& p = got.points[s.lasers + laser];
    const double azimuth = deg_to_rad(90.2) + calibration.beams[laser].azimuth_offset_rad;
    const double flat = 5 * std::cos(calibration.beams[laser].elevation_rad);
    EXPECT_EQ(p.beam, laser);
    EXPECT_NEAR(static_cast<double>(p.x_m), flat * std::sin(azimuth), 1e-5) << info(s.model).name;
    EXPECT_NEAR(static_cast<double>(p.y_m), flat * std::cos(azimuth), 1e-5) << info(s.model).name;
    for (const SweepPoint& point : got.points) ASSERT_GE(point.offset_ns, 0) << info(s.model).name;
  }
}

TEST(Hesai, DualReturn_StrongestFirstOnOneRay) {
  for (const Shape& s : kShapes) {
    const Calibration calibration = some_calibration(s.model);
    for (const uint8_t mode : {0x39, 0x3A, 0x3B, 0x3C, 0x3E}) {
      const Decoded got = decode(calibration, packet(s, mode, 2).view());
      ASSERT_TRUE(got.status.ok());
      ASSERT_EQ(got.points.size(), s.blocks * s.lasers);
      ASSERT_EQ(got.packet.blocks.size(), s.blocks / 2);
      const SweepPoint &first = got.points[0], &second = got.points[1];
      EXPECT_EQ(first.azimuth_rad, second.azimuth_rad);
      EXPECT_EQ(first.offset_ns, second.offset_ns);
      EXPECT_EQ(first.return_index, 0);
      EXPECT_EQ(second.return_index, 1);
      const double strongest_m = mode == 0x3E ? 5 : 6;  // first block; by mode or by reflectivity the second one
      EXPECT_NEAR(static_cast<double>(first.range_m), strongest_m, 1e-6) << int{mode};
    }
  }
}

TEST(Hesai, TripleReturn_OfTheXt32m) {
  const Decoded got = decode(some_calibration(Model::kXt32m), packet(kShapes[2], 0x3D, 3).view());
  ASSERT_TRUE(got.status.ok());
  ASSERT_EQ(got.points.size(), 6U * 32U);
  EXPECT_NEAR(static_cast<double>(got.points[0].range_m), 7, 1e-6) << "first, last, strongest";
  EXPECT_EQ(got.points[2].return_index, 2);
}

TEST(Hesai, OtherModelsPackets_AreRefusedAndNamed) {
  for (const Shape& s : kShapes) {
    const PacketBytes bytes = packet(s, 0x37, 1);
    const ModelInfo* named = identify_hesai(bytes.view());
    ASSERT_NE(named, nullptr) << info(s.model).name;
    EXPECT_EQ(named->model, s.model);
    for (const Shape& other : kShapes) {
      if (other.model == s.model) continue;
      EXPECT_EQ(decode(some_calibration(other.model), bytes.view()).status.code(), StatusCode::kUnsupported);
    }
  }
}

TEST(Hesai, FieldsThatContradict_AreRefused) {
  const Shape& s = kShapes[1];
  const Calibration calibration = some_calibration(s.model);
  const auto code = [&](std::size_t at, uint64_t value, int bytes, uint8_t mode = 0x37, std::size_t returns = 1) {
    PacketBytes bad = packet(s, mode, returns);
    bad.le(at, value, bytes);
    return decode(calibration, bad.view()).status.code();
  };
  EXPECT_EQ(code(s.tail + s.mode, 0x77, 1), StatusCode::kUnsupported);
  EXPECT_EQ(code(s.tail + s.mode, 0x3D, 1), StatusCode::kUnsupported) << "8 blocks make no threes";
  EXPECT_EQ(code(9, 0, 1), StatusCode::kCorrupt) << "unit of range";
  EXPECT_EQ(code(s.tail + s.us, 2'000'000, 4), StatusCode::kCorrupt);
  EXPECT_EQ(code(s.tail + s.date + 1, 13, 1), StatusCode::kCorrupt) << "month";
  EXPECT_EQ(code(unit_at(s, 2, 0) - 2, 36000, 2), StatusCode::kCorrupt);
  EXPECT_EQ(code(unit_at(s, 1, 0) - 2, 9001, 2, 0x39, 2), StatusCode::kCorrupt) << "pair with two azimuths";
  PacketBytes factory = packet(s, 0x37, 1);
  factory.le(s.tail + s.factory_at, 0x13, 1);
  EXPECT_TRUE(decode(calibration, factory.view()).header.other_sensor);
}

TEST(Hesai, AbsurdRanges_AreCountedNotGiven) {
  PacketBytes bytes = packet(kShapes[1], 0x37, 1);
  bytes.le(unit_at(kShapes[1], 0, 0), 65535, 2);  // 262 m, a PandarXT measures 120
  bytes.le(unit_at(kShapes[1], 0, 1), 5, 2);      // 2 cm
  const Decoded got = decode(some_calibration(Model::kXt32), bytes.view());
  EXPECT_EQ(got.packet.absurd_ranges, 2U);
  EXPECT_EQ(got.points.size(), 8U * 32U - 2);
}

TEST(HesaiTiming, XtBlocks_CountBackFromTheTail) {
  EXPECT_EQ(hesai_block_ns(Model::kXt32, 7, 8, 1), 5632);
  EXPECT_EQ(hesai_block_ns(Model::kXt32, 0, 8, 1), 5632 - 7 * 50000);
  EXPECT_EQ(hesai_block_ns(Model::kXt32, 0, 8, 2), 5632 - 3 * 50000);
  EXPECT_EQ(hesai_channel_ns(Model::kXt32, 31, false), 368 + 31 * 1512);
  for (const Shape& s : kShapes)
    for (std::size_t channel = 0; channel < s.lasers; ++channel)
      for (const bool loop : {false, true})
        EXPECT_GE(hesai_channel_ns(s.model, channel, loop), hesai_first_channel_ns(s.model)) << info(s.model).name;
}

}  // namespace
}  // namespace roomcal::lidar
