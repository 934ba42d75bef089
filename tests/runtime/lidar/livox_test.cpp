// Synthetic packets only: no real capture of a Mid-360 was at hand.
#include "runtime/lidar/livox.h"

#include <string>

#include <gtest/gtest.h>

#include "tests/runtime/lidar/packet_bytes.h"

namespace roomcal::lidar {
namespace {

using test::decode;
using test::Decoded;
using test::PacketBytes;

PacketBytes packet(uint8_t type, std::size_t dots) {
  const std::size_t dot = type == 1 ? 14 : 8, size = kLivoxHeadBytes + dots * dot;
  PacketBytes bytes(size);
  bytes.le(1, size, 2);
  bytes.le(3, 4800, 2);  // 480 us
  bytes.le(5, dots, 2);
  bytes.le(7, 9, 2);
  bytes.le(10, type, 1);
  bytes.le(28, 7'000'000'000, 8);
  for (std::size_t i = 0; i < dots; ++i) {
    const std::size_t at = kLivoxHeadBytes + i * dot;
    if (type == 1) {
      bytes.le(at, 3000, 4);
      bytes.le(at + 4, static_cast<uint64_t>(-4000), 4);
      bytes.le(at + 8, 12000, 4);
      bytes.le(at + 12, 99, 1);
    } else {
      bytes.le(at, 300, 2);
      bytes.le(at + 2, static_cast<uint64_t>(-400), 2);
      bytes.le(at + 4, 1200, 2);
      bytes.le(at + 6, 99, 1);
    }
  }
  bytes.le(24, crc32_ieee(bytes.view().subspan(28)), 4);
  return bytes;
}

TEST(Livox, BothDataTypes_GiveTheSamePoints) {
  const Calibration calibration = built_in_calibration(Model::kMid360).value();
  for (const uint8_t type : {1, 2}) {
    const Decoded got = decode(calibration, packet(type, 96).view());
    ASSERT_TRUE(got.status.ok()) << got.status.detail();
    ASSERT_EQ(got.points.size(), 96U);
    EXPECT_FALSE(got.header.checksum_wrong);
    const SweepPoint& p = got.points[6];
    EXPECT_NEAR(static_cast<double>(p.y_m), -4, 1e-6);
    EXPECT_NEAR(static_cast<double>(p.range_m), 13, 1e-5);
    EXPECT_EQ(p.beam, 2);
    EXPECT_EQ(p.offset_ns, 30'000);
    EXPECT_EQ(p.reflectivity, 99);
  }
}

TEST(Livox, FlippedBit_BreaksTheChecksum) {
  PacketBytes bytes = packet(1, 10);
  bytes.le(kLivoxHeadBytes, 3001, 2);
  EXPECT_TRUE(decode(built_in_calibration(Model::kMid360).value(), bytes.view()).header.checksum_wrong);
}

TEST(Livox, LengthsThatDisagree_AreRefused) {
  const Calibration calibration = built_in_calibration(Model::kMid360).value();
  PacketBytes dots = packet(1, 10);
  dots.le(5, 11, 2);
  EXPECT_EQ(decode(calibration, dots.view()).status.code(), StatusCode::kCorrupt);
  PacketBytes imu = packet(1, 10);
  imu.le(10, 0, 1);
  EXPECT_EQ(decode(calibration, imu.view()).status.code(), StatusCode::kUnsupported);
  EXPECT_EQ(decode(calibration, packet(2, 5000).view()).status.code(), StatusCode::kCorrupt)
      << "more than there is room";
  EXPECT_EQ(decode(calibration, packet(1, 10).view().first(20)).status.code(), StatusCode::kUnsupported);
}

TEST(Crc32, CheckValue_IsThePublishedOne) {
  const std::string text = "123456789";
  EXPECT_EQ(crc32_ieee(std::as_bytes(std::span<const char>(text))), 0xCBF43926U);
}

}  // namespace
}  // namespace roomcal::lidar
