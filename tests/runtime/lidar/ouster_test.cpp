#include "runtime/lidar/ouster.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/runtime/lidar/packet_bytes.h"

namespace roomcal::lidar {
namespace {

using test::decode;
using test::Decoded;
using test::PacketBytes;

constexpr std::size_t kRows = 32, kColumns = 4;
constexpr OusterProfile kProfiles[] = {OusterProfile::kLegacy, OusterProfile::kSingle19,   OusterProfile::kDual19,
                                       OusterProfile::kLow15,  OusterProfile::kFusaDual15, OusterProfile::kFiveWord};

Calibration calibration_of(OusterProfile profile) {
  OusterFormat format;
  format.profile = profile;
  format.columns_per_packet = kColumns;
  format.beam_origin_m = 0.0277;
  format.T_sensor_lidar << -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0.036, 0, 0, 0, 1;
  format.serial = 991;
  std::vector<Beam> beams(kRows);
  for (std::size_t i = 0; i < kRows; ++i) {
    beams[i].elevation_rad = deg_to_rad(15 - static_cast<double>(i));
    beams[i].azimuth_offset_rad = deg_to_rad(i % 2 == 0 ? 3 : -1);
  }
  return make_calibration(format, beams).value();
}

struct Places {
  std::size_t head, column_head, pixel, column, status;
};

Places places_of(OusterProfile profile) {
  const bool legacy = profile == OusterProfile::kLegacy;
  const std::size_t pixel = OusterPacket::pixel_bytes(profile);
  const std::size_t head = legacy ? 0 : 32, column_head = legacy ? 16 : 12;
  const std::size_t column = column_head + kRows * pixel + (legacy ? 4 : 0);
  return {head, column_head, pixel, column, legacy ? column - 4 : 10};
}

/// First returns at 8 m, second ones (where the profile has them) at 16 m.
PacketBytes packet(const Calibration& calibration, uint16_t first_column, uint32_t frame) {
  const OusterProfile profile = calibration.ouster.profile;
  const Places at = places_of(profile);
  PacketBytes bytes(OusterPacket::packet_bytes(calibration.ouster, kRows));
  const bool fusa = profile == OusterProfile::kFusaDual15;
  if (at.head > 0) {
    bytes.le(0, 1, fusa ? 1 : 2);
    bytes.le(fusa ? 4 : 2, frame, fusa ? 4 : 2);
    bytes.le(fusa ? 11 : 7, 991, 5);
  }
  for (std::size_t c = 0; c < kColumns; ++c) {
    const std::size_t column = at.head + c * at.column;
    bytes.le(column, 5'000'000'000 + 100'000 * c, 8);
    bytes.le(column + 8, first_column + c, 2);
    if (at.head == 0) bytes.le(column + 10, frame, 2);
    bytes.le(column + at.status, at.head == 0 ? 0xFFFFFFFF : 1, at.head == 0 ? 4 : 2);
    for (std::size_t r = 0; r < kRows; ++r) {
      const std::size_t pixel = column + at.column_head + r * at.pixel;
      const bool short_range = profile == OusterProfile::kLow15 || fusa;
      bytes.le(pixel, short_range ? 1000 : 8000, 2);
      if (fusa) bytes.le(pixel + 4, 2000, 2);
      if (profile == OusterProfile::kDual19 || profile == OusterProfile::kFiveWord) bytes.le(pixel + 4, 16000, 2);
    }
  }
  return bytes;
}

TEST(Ouster, EveryProfile_PutsPointsWhereTheManualSays) {
  for (const OusterProfile profile : kProfiles) {
    const Calibration calibration = calibration_of(profile);
    const Decoded got = decode(calibration, packet(calibration, 100, 77).view());
    ASSERT_TRUE(got.status.ok()) << static_cast<int>(profile) << got.status.detail();
    const bool dual = profile == OusterProfile::kDual19 || profile == OusterProfile::kFusaDual15 ||
                      profile == OusterProfile::kFiveWord;
    ASSERT_EQ(got.points.size(), kColumns * kRows * (dual ? 2 : 1));
    EXPECT_EQ(got.header.turn, 77U);
    EXPECT_EQ(got.header.packet_units, kColumns);
    EXPECT_FALSE(got.header.other_sensor);
    const std::size_t column = 2, row = 5;
    const SweepPoint& p = got.points[(column * kRows + row) * (dual ? 2 : 1)];
    const double t = 2 * kPi * (1 - 102.0 / 1024), a = -calibration.beams[row].azimuth_offset_rad;
    const double e = calibration.beams[row].elevation_rad, n = 0.0277, r = 8;
    EXPECT_NEAR(static_cast<double>(p.x_m), -((r - n) * std::cos(t + a) * std::cos(e) + n * std::cos(t)), 1e-5);
    EXPECT_NEAR(static_cast<double>(p.y_m), -((r - n) * std::sin(t + a) * std::cos(e) + n * std::sin(t)), 1e-5);
    EXPECT_NEAR(static_cast<double>(p.z_m), (r - n) * std::sin(e) + 0.036, 1e-5);
    EXPECT_EQ(p.offset_ns, 200'000);
    if (dual) {
      EXPECT_NEAR(static_cast<double>(got.points[1].range_m), 16, 1e-6);
      EXPECT_EQ(got.points[1].return_index, 1);
    }
  }
}

TEST(Ouster, InvalidColumns_GiveNoPoints) {
  for (const OusterProfile profile : kProfiles) {
    const Calibration calibration = calibration_of(profile);
    const Places at = places_of(profile);
    PacketBytes bytes = packet(calibration, 0, 1);
    bytes.le(at.head + at.status, 0, 2);
    const Decoded got = decode(calibration, bytes.view());
    ASSERT_TRUE(got.status.ok());
    EXPECT_EQ(got.points.size() % (3 * kRows), 0U);
    for (std::size_t c = 1; c < kColumns; ++c) bytes.le(at.head + c * at.column + at.status, 0, 2);
    EXPECT_EQ(decode(calibration, bytes.view()).status.code(), StatusCode::kUnavailable);
  }
}

TEST(Ouster, WhatDoesNotFit_IsRefused) {
  const Calibration calibration = calibration_of(OusterProfile::kSingle19);
  const Places at = places_of(OusterProfile::kSingle19);
  PacketBytes far = packet(calibration, 0, 1);
  far.le(at.head + at.column + 8, 1024, 2);
  EXPECT_EQ(decode(calibration, far.view()).status.code(), StatusCode::kCorrupt) << "column beyond the turn";
  PacketBytes late = packet(calibration, 0, 1);
  late.le(at.head + at.column, 1, 8);
  EXPECT_EQ(decode(calibration, late.view()).status.code(), StatusCode::kCorrupt) << "times backwards";
  PacketBytes type = packet(calibration, 0, 1);
  type.le(0, 2, 2);
  EXPECT_EQ(decode(calibration, type.view()).status.code(), StatusCode::kUnsupported);
  EXPECT_EQ(decode(calibration, far.view().first(1000)).status.code(), StatusCode::kUnsupported);
  PacketBytes other = packet(calibration, 0, 1);
  other.le(7, 992, 5);
  EXPECT_TRUE(decode(calibration, other.view()).header.other_sensor);
}

}  // namespace
}  // namespace roomcal::lidar
