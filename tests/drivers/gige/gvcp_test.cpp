#include "drivers/gige/gvcp.h"

#include <vector>

#include <gtest/gtest.h>

namespace roomcal::drivers::gvcp {
namespace {

std::vector<int> bytes_of(const Datagram& datagram) {
  std::vector<int> bytes;
  for (const std::byte b : datagram) bytes.push_back(std::to_integer<int>(b));
  return bytes;
}

std::vector<std::byte> datagram(std::initializer_list<int> bytes) {
  std::vector<std::byte> out;
  for (const int b : bytes) out.push_back(static_cast<std::byte>(b));
  return out;
}

ActionCommand example() {
  ActionCommand command;
  command.id = 0x1234;
  command.device_key = 0xA1A2A3A4;
  command.group_key = 0xB1B2B3B4;
  command.group_mask = 0x00000005;
  return command;
}

TEST(ActionCommand, AtOnce_IsTwentyBytes) {
  const std::vector<int> expected{0x42, 0x00, 0x01, 0x00, 0x00, 0x0C, 0x12, 0x34, 0xA1, 0xA2,
                                  0xA3, 0xA4, 0xB1, 0xB2, 0xB3, 0xB4, 0,    0,    0,    5};
  EXPECT_EQ(bytes_of(action_command(example())), expected);
}

TEST(ActionCommand, ScheduledAndAcknowledged_SaysSoInFlagsAndEndsWithTheTime) {
  ActionCommand command = example();
  command.acknowledge = true;
  command.action_time = 0x0102030405060708;
  const std::vector<int> expected{0x42, 0x81, 0x01, 0x00, 0x00, 0x14, 0x12, 0x34, 0xA1, 0xA2, 0xA3, 0xA4, 0xB1, 0xB2,
                                  0xB3, 0xB4, 0,    0,    0,    5,    1,    2,    3,    4,    5,    6,    7,    8};
  EXPECT_EQ(bytes_of(action_command(command)), expected);
}

TEST(ReadRegister, ControlRegister_IsTwelveBytes) {
  const std::vector<int> expected{0x42, 0x01, 0x00, 0x80, 0x00, 0x04, 0x00, 0x07, 0x00, 0x00, 0x0A, 0x00};
  EXPECT_EQ(bytes_of(read_register(7, kControlRegister)), expected);
}

TEST(Acknowledgement, OfAnAction_GivesStatusAndId) {
  const auto ack = parse_acknowledgement(datagram({0x80, 0x16, 0x01, 0x01, 0, 0, 0x12, 0x34}), Answer::kAction);
  ASSERT_TRUE(ack.has_value());
  EXPECT_EQ(ack->status, kActionLate);
  EXPECT_EQ(ack->id, 0x1234);
}

TEST(Acknowledgement, OfARegister_GivesItsValue) {
  const auto ack = parse_acknowledgement(datagram({0, 0, 0x00, 0x81, 0, 4, 0, 7, 0, 0, 0, 2}), Answer::kReadRegister);
  ASSERT_TRUE(ack.has_value());
  EXPECT_EQ(ack->value, 2U);
}

TEST(Acknowledgement, RefusedRegister_NeedsNoValue) {
  const auto ack = parse_acknowledgement(datagram({0x80, 0x06, 0x00, 0x81, 0, 0, 0, 7}), Answer::kReadRegister);
  ASSERT_TRUE(ack.has_value());
  EXPECT_EQ(ack->status, kAccessDenied);
}

TEST(Acknowledgement, OtherOrTornDatagrams_AreNone) {
  const std::vector<std::byte> whole = datagram({0, 0, 0x00, 0x81, 0, 4, 0, 7, 0, 0, 0, 2});
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(parse_acknowledgement(std::span(whole).first(size), Answer::kReadRegister).has_value()) << size;
  EXPECT_FALSE(parse_acknowledgement(whole, Answer::kAction).has_value());
  EXPECT_FALSE(parse_acknowledgement(datagram({0, 0, 0x00, 0x81, 0, 0, 0, 7}), Answer::kReadRegister).has_value());
}

}  // namespace
}  // namespace roomcal::drivers::gvcp
