#include "runtime/lidar/robosense.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/runtime/lidar/packet_bytes.h"

namespace roomcal::lidar {
namespace {

using test::decode;
using test::Decoded;
using test::PacketBytes;

PacketBytes packet() {
  PacketBytes bytes(kRobosensePacketBytes);
  bytes.be(0, kMsopId, 4);
  bytes.be(20, 1'700'000'000, 6);
  bytes.be(26, 250'000, 4);
  bytes.be(30, 6, 1);
  for (std::size_t block = 0; block < 12; ++block) {
    bytes.be(42 + block * 100, 0xFFEE, 2);
    bytes.be(44 + block * 100, 100 + 40 * block, 2);
    for (std::size_t i = 0; i < 32; ++i) bytes.be(46 + block * 100 + 3 * i, i < 16 ? 2000 : 2400, 2);  // 5 m, 6 m
  }
  return bytes;
}

TEST(Robosense, SingleReturn_TwoFiringsABlock) {
  const Calibration calibration = built_in_calibration(Model::kHelios16p).value();
  const Decoded got = decode(calibration, packet().view());
  ASSERT_TRUE(got.status.ok()) << got.status.detail();
  ASSERT_EQ(got.points.size(), 384U);
  EXPECT_EQ(got.header.stamp_ns, 1'700'000'000'250'000'000);
  const SweepPoint& p = got.points[32 + 17];  // second firing of the second block, laser 1
  const double lens = deg_to_rad(1.40 + 0.01 * std::floor(40 * 58.70 / 111.12));
  const double azimuth = lens + calibration.beams[1].azimuth_offset_rad, e = calibration.beams[1].elevation_rad;
  EXPECT_NEAR(static_cast<double>(p.x_m), 6 * std::cos(e) * std::cos(azimuth) + 0.03498 * std::cos(lens), 1e-5);
  EXPECT_NEAR(static_cast<double>(p.y_m), -6 * std::cos(e) * std::sin(azimuth) - 0.03498 * std::sin(lens), 1e-5);
  EXPECT_NEAR(static_cast<double>(p.z_m), 6 * std::sin(e), 1e-5);
  EXPECT_NEAR(p.offset_ns, 111'120 + 58'700, 2);
}

TEST(Robosense, DualReturn_OneFiringABlock) {
  Calibration calibration = built_in_calibration(Model::kHelios16p).value();
  calibration.dual_returns = true;
  const Decoded got = decode(calibration, packet().view());
  ASSERT_EQ(got.points.size(), 384U);
  const SweepPoint &first = got.points[3], &second = got.points[16 + 3];
  EXPECT_EQ(first.azimuth_rad, second.azimuth_rad);
  EXPECT_EQ(first.offset_ns, second.offset_ns);
  EXPECT_EQ(second.return_index, 1);
}

TEST(ReadDifop, AnglesAndMode_ReplaceTheManuals) {
  PacketBytes bytes(kRobosensePacketBytes);
  bytes.be(0, kDifopId, 4);
  bytes.be(300, 0, 1);
  for (std::size_t i = 0; i < 16; ++i) {
    bytes.be(468 + 3 * i, i < 8 ? 0 : 1, 1);
    bytes.be(469 + 3 * i, 100 * (i < 8 ? 8 - i : i - 7), 2);
    bytes.be(564 + 3 * i, 1, 1);
    bytes.be(565 + 3 * i, 350, 2);
  }
  Calibration calibration = built_in_calibration(Model::kHelios16p).value();
  ASSERT_TRUE(read_difop(bytes.view(), calibration).ok());
  EXPECT_TRUE(calibration.dual_returns && calibration.from_unit);
  EXPECT_NEAR(rad_to_deg(calibration.beams[0].elevation_rad), 8, 1e-9);
  EXPECT_NEAR(rad_to_deg(calibration.beams[15].elevation_rad), -8, 1e-9);
  EXPECT_NEAR(rad_to_deg(calibration.beams[4].azimuth_offset_rad), -3.5, 1e-9);
  PacketBytes empty(kRobosensePacketBytes);
  empty.be(0, kDifopId, 4);
  EXPECT_EQ(read_difop(empty.view(), calibration).code(), StatusCode::kUnavailable);
  EXPECT_EQ(read_difop(packet().view(), calibration).code(), StatusCode::kUnsupported);
}

TEST(Robosense, FieldsThatContradict_AreRefused) {
  const Calibration calibration = built_in_calibration(Model::kHelios16p).value();
  const auto code = [&](std::size_t at, uint64_t value, int bytes) {
    PacketBytes bad = packet();
    bad.be(at, value, bytes);
    return decode(calibration, bad.view()).status.code();
  };
  EXPECT_EQ(code(0, 0, 4), StatusCode::kUnsupported);
  EXPECT_EQ(code(142, 0xFFEF, 2), StatusCode::kCorrupt);
  EXPECT_EQ(code(144, 20000, 2), StatusCode::kCorrupt);
  EXPECT_EQ(code(144, 36000, 2), StatusCode::kCorrupt);
  EXPECT_EQ(code(26, 1'000'000, 4), StatusCode::kCorrupt);
  PacketBytes type = packet();
  type.be(30, 3, 1);
  EXPECT_TRUE(decode(calibration, type.view()).header.other_sensor);
}

}  // namespace
}  // namespace roomcal::lidar
