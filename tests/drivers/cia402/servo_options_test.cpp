#include "drivers/cia402/servo_options.h"

#include <limits>
#include <string>

#include <gtest/gtest.h>

namespace roomcal::drivers::cia402 {
namespace {

TEST(ServoOptions, Defaults_AreGood) { EXPECT_TRUE(check({}).ok()); }

TEST(ServoOptions, WhatCannotWork_IsNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto said = [](const ServoOptions& options) {
    EXPECT_EQ(check(options).code(), StatusCode::kInvalidArgument);
    return std::string(check(options).detail());
  };
  EXPECT_NE(said({.node_id = 0}).find("node id"), std::string::npos);
  EXPECT_NE(said({.node_id = 128}).find("node id"), std::string::npos);
  EXPECT_NE(said({.node_id = 127}).find("own node id"), std::string::npos);
  EXPECT_NE(said({.counts_per_turn = 0}).find("counts per turn"), std::string::npos);
  EXPECT_NE(said({.counts_per_turn = nan}).find("counts per turn"), std::string::npos);
  EXPECT_NE(said({.velocity_units_per_count = 1e9}).find("velocity units"), std::string::npos);
  EXPECT_NE(said({.acceleration_units_per_count = 1e-9}).find("acceleration"), std::string::npos);
  EXPECT_NE(said({.max_speed_radps = nan}).find("speed"), std::string::npos);
  EXPECT_NE(said({.homing_method = 1, .homing_speed_radps = 99}).find("homing"), std::string::npos);
  EXPECT_NE(said({.sync_period_ns = 0}).find("SYNC"), std::string::npos);
  EXPECT_NE(said({.sdo_timeout_ns = 0}).find("time-outs"), std::string::npos);
  EXPECT_NE(said({.heartbeat_period_ns = 1}).find("heartbeat"), std::string::npos);
}

TEST(ServoOptions, ReversedGear_TurnsTheOtherWay) {
  const ServoOptions options{.counts_per_turn = -1000};
  EXPECT_DOUBLE_EQ(counts_of(options, 6.283185307179586), -1000);
  EXPECT_DOUBLE_EQ(angle_of(options, -250), 6.283185307179586 / 4);
}

TEST(ServoOptions, Setup_SwitchesPdosOffBeforeTheyAreMapped) {
  const auto setup = setup_of({.node_id = 5, .homing_method = 35});
  const auto place = [&](uint16_t index, uint8_t sub, uint32_t value) {
    for (std::size_t i = 0; i < setup.size(); ++i)
      if (setup[i].key == ObjectKey{index, sub} && setup[i].value == value) return i;
    ADD_FAILURE() << std::hex << index << " " << value << " is not written";
    return setup.size();
  };
  EXPECT_LT(place(0x1800, 1, 0xC0000185), place(0x1A00, 0, 0));
  EXPECT_LT(place(0x1A00, 0, 0), place(0x1A00, 1, 0x60410010));
  EXPECT_LT(place(0x1A00, 2, 0x60640020), place(0x1A00, 0, 2));
  EXPECT_LT(place(0x1A00, 0, 2), place(0x1800, 1, 0x40000185));
  EXPECT_LT(place(0x1400, 1, 0x80000205), place(0x1600, 1, 0x60400010));
  EXPECT_LT(place(0x1600, 2, 0x60FF0020), place(0x1400, 1, 0x00000205));
  place(0x1017, 0, 100);
  place(0x1016, 1, 127U << 16 | 300);
  place(0x6098, 0, 35);
  EXPECT_FALSE(setup.full()) << "nothing was left out";
}

}  // namespace
}  // namespace roomcal::drivers::cia402
