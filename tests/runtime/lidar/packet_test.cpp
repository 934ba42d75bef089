#include "runtime/lidar/packet.h"

#include <array>

#include <gtest/gtest.h>

#include "runtime/lidar/point_sink.h"
#include "runtime/lidar/utc.h"
#include "tests/runtime/lidar/packet_bytes.h"

namespace roomcal::lidar {
namespace {

using test::PacketBytes;

TEST(ClassifyPacket, WhatSharesTheNetwork_IsNamed) {
  EXPECT_EQ(classify_packet(Model::kVlp16, PacketBytes(512).view()), PacketKind::kPosition);
  EXPECT_EQ(classify_packet(Model::kVlp16, PacketBytes(1206).view()), PacketKind::kPoints);
  EXPECT_EQ(classify_packet(Model::kOuster, PacketBytes(48).view()), PacketKind::kImu);
  EXPECT_EQ(classify_packet(Model::kMid360, PacketBytes(60).view()), PacketKind::kImu);
  PacketBytes difop(1248);
  difop.be(0, 0xA5FF005A, 4);
  EXPECT_EQ(classify_packet(Model::kHelios16p, difop.view()), PacketKind::kDifop);
  for (const ModelInfo& model : known_models())
    EXPECT_EQ(classify_packet(model.model, PacketBytes(0).view()), PacketKind::kOther) << model.name;
}

TEST(AzimuthsPlausible, EvenStepsAndOneJump_ButNoToAndFro) {
  EXPECT_TRUE(azimuths_plausible(std::array<uint16_t, 4>{35980, 0, 20, 41}));
  EXPECT_TRUE(azimuths_plausible(std::array<uint16_t, 4>{9000, 9020, 27000, 27020})) << "a field of view";
  EXPECT_FALSE(azimuths_plausible(std::array<uint16_t, 4>{100, 120, 8000, 160}));
  EXPECT_FALSE(azimuths_plausible(std::array<uint16_t, 4>{100, 80, 60, 40})) << "backwards";
  EXPECT_TRUE(azimuths_plausible(std::array<uint16_t, 1>{100}));
}

TEST(DecodePacket, TooLittleRoom_IsRefused) {
  std::array<SweepPoint, 10> points;
  DecodedPacket decoded;
  EXPECT_EQ(decode_packet(built_in_calibration(Model::kVlp16).value(), {}, PacketBytes(1206).view(), 0, points, decoded)
                .code(),
            StatusCode::kCapacity);
}

TEST(UtcSeconds, LeapDaysAndCenturies_AreRight) {
  EXPECT_EQ(utc_seconds(1970, 1, 1, 0, 0, 0), 0);
  EXPECT_EQ(utc_seconds(2000, 3, 1, 0, 0, 0) - utc_seconds(2000, 2, 28, 0, 0, 0), 2 * 86400);
  EXPECT_EQ(utc_seconds(2100, 3, 1, 0, 0, 0) - utc_seconds(2100, 2, 28, 0, 0, 0), 86400);
}

}  // namespace
}  // namespace roomcal::lidar
