// Synthetic packets only: no real capture of an R2000 was at hand.
#include "runtime/lidar/r2000.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/runtime/lidar/packet_bytes.h"

namespace roomcal::lidar {
namespace {

using test::decode;
using test::Decoded;
using test::PacketBytes;

PacketBytes packet(char type, std::size_t points) {
  const std::size_t each = type == 'B' ? 6 : 4, size = kR2000HeadBytes + points * each;
  PacketBytes bytes(size);
  bytes.le(0, 0xA25C, 2);
  bytes.le(2, static_cast<uint64_t>(type), 2);
  bytes.le(4, size, 4);
  bytes.le(8, kR2000HeadBytes, 2);
  bytes.le(10, 12, 2);
  bytes.le(14, (uint64_t{3} << 32) | 0x80000000, 8);  // 3.5 s
  bytes.le(34, 50'000, 4);                            // 50 Hz
  bytes.le(38, 3600, 2);
  bytes.le(40, points, 2);
  bytes.le(42, 100, 2);
  bytes.le(44, static_cast<uint64_t>(-1'700'000), 4);  // -170 degrees
  bytes.le(48, 1000, 4);                               // 0.1 degree
  for (std::size_t i = 0; i < points; ++i) {
    bytes.le(kR2000HeadBytes + i * each, type == 'C' ? 2500 | 77U << 20 : 2500, 4);
    if (type == 'B') bytes.le(kR2000HeadBytes + i * each + 4, 77, 2);
  }
  return bytes;
}

TEST(R2000, EveryPacketType_GivesPointsInThePlane) {
  const Calibration calibration = built_in_calibration(Model::kR2000).value();
  for (const char type : {'A', 'B', 'C'}) {
    const Decoded got = decode(calibration, packet(type, 300).view());
    ASSERT_TRUE(got.status.ok()) << got.status.detail();
    ASSERT_EQ(got.points.size(), 300U);
    EXPECT_EQ(got.header.stamp_ns, 3'500'000'000);
    EXPECT_EQ(got.header.turn_units, 3600U);
    EXPECT_EQ(got.header.motor_rpm, 3000);
    const SweepPoint& p = got.points[50];
    EXPECT_NEAR(static_cast<double>(p.azimuth_rad), deg_to_rad(360 - 165), 1e-6);
    EXPECT_NEAR(static_cast<double>(p.x_m), 2.5 * std::cos(deg_to_rad(-165)), 1e-6);
    EXPECT_NEAR(static_cast<double>(p.y_m), 2.5 * std::sin(deg_to_rad(-165)), 1e-6);
    EXPECT_EQ(p.reflectivity, type == 'A' ? 0 : 77);
    EXPECT_NEAR(p.offset_ns, 50 * 20e6 / 3600, 2);
  }
}

TEST(R2000, NoEcho_IsNoPoint) {
  PacketBytes bytes = packet('C', 3);
  bytes.le(kR2000HeadBytes, 0xFFFFF, 4);
  EXPECT_EQ(decode(built_in_calibration(Model::kR2000).value(), bytes.view()).points.size(), 2U);
}

TEST(R2000, FrequencyBeyondAnyMotor_IsNoOverflow) {
  PacketBytes bytes = packet('C', 3);
  bytes.le(34, 0xFFFFFFFF, 4);
  EXPECT_EQ(decode(built_in_calibration(Model::kR2000).value(), bytes.view()).header.motor_rpm, 65535);
}

TEST(R2000, SizesThatDisagree_AreRefused) {
  const Calibration calibration = built_in_calibration(Model::kR2000).value();
  const auto code = [&](std::size_t at, uint64_t value, int bytes) {
    PacketBytes bad = packet('C', 30);
    bad.le(at, value, bytes);
    return decode(calibration, bad.view()).status.code();
  };
  EXPECT_EQ(code(0, 1, 2), StatusCode::kUnsupported);
  EXPECT_EQ(code(2, 'D', 2), StatusCode::kUnsupported);
  EXPECT_EQ(code(4, 999, 4), StatusCode::kCorrupt);
  EXPECT_EQ(code(8, 9999, 2), StatusCode::kCorrupt);
  EXPECT_EQ(code(40, 31, 2), StatusCode::kCorrupt);
  EXPECT_EQ(code(42, 3590, 2), StatusCode::kCorrupt);
  EXPECT_EQ(code(38, 0, 2), StatusCode::kCorrupt);
}

}  // namespace
}  // namespace roomcal::lidar
