#include "runtime/lidar/velodyne.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/runtime/lidar/packet_bytes.h"

namespace roomcal::lidar {
namespace {

using test::decode;
using test::Decoded;
using test::PacketBytes;

/// Every channel of every block sees 10 m in the model's units; azimuths step evenly.
PacketBytes packet(Model model, uint8_t mode, uint16_t first_cdeg, uint16_t step_cdeg) {
  PacketBytes bytes(kVelodynePacketBytes);
  const int range = model == Model::kVlp32c ? 2500 : 5000;
  for (std::size_t block = 0; block < 12; ++block) {
    const std::size_t group = mode == kVelodyneDual ? block / 2 : block;
    bytes.le(block * 100, 0xEEFF, 2);
    bytes.le(block * 100 + 2, (first_cdeg + group * step_cdeg) % 36000, 2);
    for (std::size_t i = 0; i < 32; ++i) {
      bytes.le(block * 100 + 4 + 3 * i, static_cast<uint64_t>(range), 2);
      bytes.le(block * 100 + 6 + 3 * i, i, 1);
    }
  }
  bytes.le(1200, 1'000'000, 4);
  bytes.le(1204, mode, 1);
  bytes.le(1205, info(model).product_byte, 1);
  return bytes;
}

TEST(Velodyne, AzimuthAndTime_FollowTheManualsTables) {
  struct Case {
    Model model;
    std::size_t channel;
    double time_us, block_us;
  };
  for (const Case& c : {Case{Model::kVlp16, 0, 0, 110.592}, Case{Model::kVlp16, 15, 34.56, 110.592},
                        Case{Model::kVlp16, 31, 55.296 + 34.56, 110.592}, Case{Model::kVlp32c, 31, 34.56, 55.296},
                        Case{Model::kVlp32c, 1, 0, 55.296}, Case{Model::kHdl32e, 31, 35.712, 46.08}}) {
    EXPECT_NEAR(velodyne_channel_us(c.model, c.channel), c.time_us, 1e-9);
    const Calibration calibration = built_in_calibration(c.model).value();
    const Decoded got = decode(calibration, packet(c.model, kVelodyneStrongest, 35990, 20).view());
    ASSERT_TRUE(got.status.ok()) << got.status.detail();
    ASSERT_EQ(got.points.size(), 384U);
    for (const std::size_t block : {0U, 1U, 11U}) {
      const SweepPoint& p = got.points[block * 32 + c.channel];
      const double cdeg = 35990 + 20.0 * static_cast<double>(block) + 20 * c.time_us / c.block_us;
      const double azimuth = deg_to_rad(cdeg / 100) + calibration.beams[p.beam].azimuth_offset_rad;
      EXPECT_NEAR(std::remainder(static_cast<double>(p.azimuth_rad) - azimuth, 2 * kPi), 0, 1e-6);
      EXPECT_NEAR(p.offset_ns, 1000 * (c.block_us * static_cast<double>(block) + c.time_us), 1);
      const double elevation = calibration.beams[p.beam].elevation_rad;
      EXPECT_NEAR(static_cast<double>(p.x_m), 10 * std::cos(elevation) * std::sin(azimuth), 1e-5);
      EXPECT_NEAR(static_cast<double>(p.y_m), 10 * std::cos(elevation) * std::cos(azimuth), 1e-5);
      EXPECT_NEAR(static_cast<double>(p.z_m), 10 * std::sin(elevation), 1e-5);
    }
  }
}

TEST(Velodyne, DualReturn_InterpolatesTowardsTheNextPair) {
  PacketBytes bytes = packet(Model::kVlp16, kVelodyneDual, 100, 40);
  for (std::size_t block = 0; block < 12; block += 2) bytes.le(block * 100 + 4, 6000, 2);  // laser 0: last at 12 m
  const Decoded got = decode(built_in_calibration(Model::kVlp16).value(), bytes.view());
  ASSERT_TRUE(got.status.ok());
  EXPECT_EQ(got.points.size(), 6U * 33U) << "equal ranges are one point";
  EXPECT_EQ(got.packet.blocks.size(), 6U);
  const SweepPoint &strongest = got.points[0], &last = got.points[1];
  EXPECT_EQ(strongest.return_index, 0);
  EXPECT_NEAR(static_cast<double>(strongest.range_m), 10, 1e-6);
  EXPECT_EQ(last.return_index, 1);
  EXPECT_NEAR(static_cast<double>(last.range_m), 12, 1e-6);
  EXPECT_EQ(strongest.azimuth_rad, last.azimuth_rad);
  const double part = velodyne_channel_us(Model::kVlp16, 31) / 110.592;
  EXPECT_NEAR(rad_to_deg(static_cast<double>(got.points[32].azimuth_rad)), 1 + 0.4 * part, 1e-4);
  EXPECT_NEAR(rad_to_deg(static_cast<double>(got.points.back().azimuth_rad)), 3 + 0.4 * part, 1e-4) << "last pair too";
}

TEST(Velodyne, JumpOverAnglesThatAreOff_IsNoTurn) {
  PacketBytes bytes = packet(Model::kVlp16, kVelodyneStrongest, 8000, 40);
  for (std::size_t block = 6; block < 12; ++block) bytes.le(block * 100 + 2, 30000 + 40 * (block - 6), 2);
  const Decoded got = decode(built_in_calibration(Model::kVlp16).value(), bytes.view());
  ASSERT_TRUE(got.status.ok());
  const SweepPoint& before = got.points[5 * 32 + 31];
  EXPECT_NEAR(rad_to_deg(static_cast<double>(before.azimuth_rad)),
              82 + 0.4 * velodyne_channel_us(Model::kVlp16, 31) / 110.592, 1e-4);
}

TEST(Velodyne, FieldsThatContradict_AreRefused) {
  const Calibration calibration = built_in_calibration(Model::kVlp16).value();
  const PacketBytes good = packet(Model::kVlp16, kVelodyneStrongest, 100, 40);
  const auto code = [&](std::size_t at, uint64_t value, int bytes) {
    PacketBytes bad = good;
    bad.le(at, value, bytes);
    return decode(calibration, bad.view()).status.code();
  };
  EXPECT_EQ(code(300, 0, 1), StatusCode::kCorrupt) << "block mark";
  EXPECT_EQ(code(302, 36001, 2), StatusCode::kCorrupt) << "azimuth";
  EXPECT_EQ(code(302, 20000, 2), StatusCode::kCorrupt) << "azimuths to and fro";
  EXPECT_EQ(code(1204, 0x40, 1), StatusCode::kUnsupported) << "return mode";
  EXPECT_EQ(code(1204, kVelodyneDual, 1), StatusCode::kCorrupt) << "pairs with two azimuths";
  EXPECT_EQ(code(1200, 3'600'000'000, 4), StatusCode::kCorrupt) << "beyond the hour";
  EXPECT_EQ(code(302, 36000, 2), StatusCode::kCorrupt) << "360 degrees is 0, and that is no even step here";
  EXPECT_EQ(decode(calibration, good.view().first(1205)).status.code(), StatusCode::kUnsupported);
  EXPECT_TRUE(decode(calibration, packet(Model::kHdl32e, kVelodyneStrongest, 0, 20).view()).header.other_sensor);
}

TEST(Velodyne, AzimuthOf360Degrees_Is0) {
  PacketBytes bytes = packet(Model::kVlp16, kVelodyneStrongest, 35920, 80);
  bytes.le(100 + 2, 36000, 2);
  const Decoded got = decode(built_in_calibration(Model::kVlp16).value(), bytes.view());
  ASSERT_TRUE(got.status.ok()) << got.status.detail();
  EXPECT_EQ(got.packet.blocks[1].azimuth_cdeg, 0);
}

TEST(Velodyne, OffsetsOfTheUnitsFile_MoveThePoint) {
  std::vector<Beam> beams(16);
  for (std::size_t i = 0; i < 16; ++i) beams[i].elevation_rad = 0.01 * static_cast<double>(i);
  beams[0] = {0, 0, 0.5, 0.011, 0.002};
  const Calibration calibration = make_calibration(Model::kVlp16, beams).value();
  const Decoded got = decode(calibration, packet(Model::kVlp16, kVelodyneStrongest, 0, 40).view());
  EXPECT_NEAR(static_cast<double>(got.points[0].range_m), 10.5, 1e-6);
  EXPECT_NEAR(static_cast<double>(got.points[0].z_m), 0.011, 1e-6);
  EXPECT_NEAR(static_cast<double>(got.points[0].x_m), -0.002, 1e-6);
}

}  // namespace
}  // namespace roomcal::lidar
