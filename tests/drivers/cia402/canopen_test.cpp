#include "drivers/cia402/canopen.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace roomcal::drivers::cia402 {
namespace {

std::vector<uint8_t> bytes_of(const ports::CanMessage& message) {
  return {message.bytes().begin(), message.bytes().end()};
}

TEST(CanOpen, Identifiers_AreOfThePredefinedConnectionSet) {
  EXPECT_EQ(emergency_id(5), 0x085U);
  EXPECT_EQ(tpdo1_id(5), 0x185U);
  EXPECT_EQ(rpdo1_id(5), 0x205U);
  EXPECT_EQ(sdo_answer_id(5), 0x585U);
  EXPECT_EQ(sdo_request_id(5), 0x605U);
  EXPECT_EQ(heartbeat_id(127), 0x77FU);
}

TEST(CanOpen, Messages_AreAsCia301LaysThemOut) {
  const ports::CanMessage nmt = nmt_message(NmtCommand::kResetNode, 5);
  EXPECT_EQ(nmt.id, 0U);
  EXPECT_EQ(bytes_of(nmt), (std::vector<uint8_t>{0x81, 5}));
  EXPECT_EQ(sync_message().id, 0x80U);
  EXPECT_EQ(sync_message().length, 0);
  const ports::CanMessage heartbeat = heartbeat_message(127, NmtState::kOperational);
  EXPECT_EQ(heartbeat.id, 0x77FU);
  EXPECT_EQ(bytes_of(heartbeat), (std::vector<uint8_t>{5}));
}

TEST(CanOpen, Heartbeat_LeavesOutTheToggleBit) {
  ports::CanMessage message = heartbeat_message(5, NmtState::kOperational);
  message.data[0] |= 0x80;
  NmtState state{};
  ASSERT_TRUE(read_heartbeat(message, state));
  EXPECT_EQ(state, NmtState::kOperational);
  message.length = 0;
  EXPECT_FALSE(read_heartbeat(message, state));
}

TEST(CanOpen, Emergency_IsReadWithItsName) {
  ports::CanMessage message;
  message.length = 8;
  message.data[0] = 0x11;
  message.data[1] = 0x86;
  message.data[2] = 0x21;
  Emergency emergency;
  ASSERT_TRUE(read_emergency(message, emergency));
  EXPECT_EQ(emergency.code, 0x8611);
  EXPECT_EQ(emergency.error_register, 0x21);
  EXPECT_STREQ(emergency_name(0x8611), "following error");
  EXPECT_STREQ(emergency_name(0x8699), "positioning") << "the class where the code itself is not known";
  EXPECT_STREQ(emergency_name(0x3210), "voltage");
  EXPECT_STREQ(emergency_name(0), "no error");
  EXPECT_STREQ(emergency_name(0x0001), "unknown error");
  message.length = 7;
  EXPECT_FALSE(read_emergency(message, emergency));
}

TEST(CanOpen, LittleEndian_ThereAndBack) {
  std::array<uint8_t, 4> bytes{};
  put_le(0x12345678, bytes);
  EXPECT_EQ(bytes, (std::array<uint8_t, 4>{0x78, 0x56, 0x34, 0x12}));
  EXPECT_EQ(le(bytes), 0x12345678U);
  EXPECT_EQ(le(std::span(bytes).first(2)), 0x5678U);
}

}  // namespace
}  // namespace roomcal::drivers::cia402
