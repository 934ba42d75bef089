#include "drivers/can/protection.h"

#include <string_view>

#include <gtest/gtest.h>

#include "drivers/can/roomcal_dbc_generated.h"

namespace roomcal::drivers {
namespace {

std::span<const uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

TEST(Protection, CheckValue_AsPublished) {
  // Of CRC-8 with polynomial 0x1D, start and xor 0; SAE J1850 itself starts with and xors 0xFF: 0x4B.
  EXPECT_EQ(crc8(bytes_of("123456789")), 0x37);
  EXPECT_EQ(crc8(bytes_of("123456789"), 0xFF) ^ 0xFF, 0x4B);
  EXPECT_EQ(crc8(bytes_of("6789"), crc8(bytes_of("12345"))), 0x37);
}

TEST(Protection, ExampleOfTheStandard_IsMet) {
  // PRS E2E Protocol, profile 11, "DataIDMode BOTH": DataId 0x123, eight bytes of zeros, counters 0 and 1.
  MessageLayout layout = dbc::cal_status::kLayout;
  layout.data_id = 0x123;
  ports::CanMessage message = blank(layout);
  protect(layout, 0, message);
  EXPECT_EQ(message.data[0], 0xCC);
  protect(layout, 1, message);
  EXPECT_EQ(message.data[0], 0x91);
  EXPECT_EQ(message.data[1], 0x01);
}

TEST(Protection, EveryBitOfEveryMessage_IsCovered) {
  for (const MessageLayout* layout : dbc::kMessages) {
    ports::CanMessage message = blank(*layout);
    for (const Signal& signal : layout->signals) put_clamped(signal, 5, message);
    protect(*layout, 9, message);
    EXPECT_EQ(check_protection(*layout, message), Protection::kGood);
    EXPECT_EQ(counter_of(message), 9);
    for (unsigned bit = 0; bit < 8U * layout->length; ++bit) {
      ports::CanMessage damaged = message;
      damaged.data[bit / 8] ^= static_cast<uint8_t>(1U << bit % 8);
      EXPECT_EQ(check_protection(*layout, damaged), Protection::kBadChecksum) << layout->name << " bit " << bit;
    }
  }
}

TEST(Protection, MessageOfAnotherKind_IsNotTakenForThisOne) {
  // Same length, other DataId: a gateway that routes to the wrong identifier is noticed.
  ports::CanMessage message = blank(dbc::cal_trigger::kLayout);
  protect(dbc::cal_trigger::kLayout, 3, message);
  EXPECT_EQ(check_protection(dbc::cal_trigger_in::kLayout, message), Protection::kBadChecksum);
  message.length = 7;
  EXPECT_EQ(check_protection(dbc::cal_trigger::kLayout, message), Protection::kOtherLength);
}

TEST(Protection, CounterFifteen_IsRefused) {
  ports::CanMessage message = blank(dbc::veh_motion::kLayout);
  protect(dbc::veh_motion::kLayout, 15, message);
  EXPECT_EQ(check_protection(dbc::veh_motion::kLayout, message), Protection::kBadCounter);
}

TEST(Protection, CounterAfterFourteen_IsZero) {
  EXPECT_EQ(counter_after(13), 14);
  EXPECT_EQ(counter_after(14), 0);
}

}  // namespace
}  // namespace roomcal::drivers
