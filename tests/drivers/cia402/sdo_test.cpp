#include "drivers/cia402/sdo.h"

#include <gtest/gtest.h>

#include "tests/fakes/fake_can_bus.h"
#include "tests/fakes/manual_clocks.h"

namespace roomcal::drivers::cia402 {
namespace {

constexpr int64_t kMs = 1'000'000;

struct SdoTest : testing::Test {
  std::vector<uint8_t> last() const { return {bus.sent().back().bytes().begin(), bus.sent().back().bytes().end()}; }
  void answer(const std::vector<uint8_t>& bytes) {
    ports::CanMessage message;
    message.id = sdo_answer_id(5);
    message.length = static_cast<uint8_t>(bytes.size());
    std::copy(bytes.begin(), bytes.end(), message.data.begin());
    client.hear(message);
  }

  fakes::ManualClocks clocks;
  fakes::FakeCanBus bus{clocks};
  SdoClient client{bus, 5, 500 * kMs};
};

TEST_F(SdoTest, Write_OfEveryLength) {
  client.download({0x6060, 0}, 0x03, 1, 0);
  EXPECT_EQ(bus.sent().back().id, 0x605U);
  EXPECT_EQ(last(), (std::vector<uint8_t>{0x2F, 0x60, 0x60, 0x00, 0x03, 0, 0, 0}));
  client.download({0x1017, 0}, 0x1234, 2, 0);
  EXPECT_EQ(last(), (std::vector<uint8_t>{0x2B, 0x17, 0x10, 0x00, 0x34, 0x12, 0, 0}));
  client.download({0x1A00, 2}, 0x60640020, 4, 0);
  EXPECT_EQ(last(), (std::vector<uint8_t>{0x23, 0x00, 0x1A, 0x02, 0x20, 0x00, 0x64, 0x60}));
  EXPECT_EQ(client.state(), SdoState::kBusy);
  answer({0x60, 0x00, 0x1A, 0x02, 0, 0, 0, 0});
  EXPECT_EQ(client.state(), SdoState::kDone);
}

TEST_F(SdoTest, Read_OfEveryLength) {
  const auto read = [&](const std::vector<uint8_t>& bytes) {
    client.upload({0x6061, 0}, 0);
    EXPECT_EQ(last(), (std::vector<uint8_t>{0x40, 0x61, 0x60, 0, 0, 0, 0, 0}));
    answer(bytes);
    EXPECT_EQ(client.state(), SdoState::kDone);
    return client.value();
  };
  EXPECT_EQ(read({0x4F, 0x61, 0x60, 0, 0xFD, 0xAA, 0xBB, 0xCC}), 0xFDU) << "the rest is not of it";
  EXPECT_EQ(read({0x4B, 0x61, 0x60, 0, 0x34, 0x12, 0xBB, 0xCC}), 0x1234U);
  EXPECT_EQ(read({0x43, 0x61, 0x60, 0, 0x78, 0x56, 0x34, 0x12}), 0x12345678U);
  EXPECT_EQ(read({0x42, 0x61, 0x60, 0, 0x78, 0x56, 0x34, 0x12}), 0x12345678U) << "a size that is not said";
}

TEST_F(SdoTest, Abort_HasCodeAndName) {
  client.upload({0x6061, 0}, 0);
  answer({0x80, 0x61, 0x60, 0, 0x00, 0x00, 0x02, 0x06});
  EXPECT_EQ(client.state(), SdoState::kAborted);
  EXPECT_EQ(client.abort_code(), kAbortNoObject);
  EXPECT_STREQ(abort_name(client.abort_code()), "object does not exist");
  EXPECT_STREQ(abort_name(0x12345678), "unknown reason");
}

TEST_F(SdoTest, AnswersToSomethingElse_AreIgnored) {
  client.upload({0x6061, 0}, 0);
  answer({0x43, 0x60, 0x60, 0, 1, 2, 3, 4});
  answer({0x43, 0x61, 0x60, 1, 1, 2, 3, 4});
  answer({0x43, 0x61, 0x60, 0, 1, 2, 3});
  EXPECT_EQ(client.state(), SdoState::kBusy);
  answer({0x43, 0x61, 0x60, 0, 1, 2, 3, 4});
  EXPECT_EQ(client.state(), SdoState::kDone);
  answer({0x80, 0x61, 0x60, 0, 0, 0, 2, 6});
  EXPECT_EQ(client.state(), SdoState::kDone);
}

TEST_F(SdoTest, AnswerThatIsNotExpedited_IsAborted) {
  client.upload({0x1008, 0}, 0);
  answer({0x41, 0x08, 0x10, 0, 20, 0, 0, 0});
  EXPECT_EQ(client.state(), SdoState::kAborted);
  EXPECT_EQ(client.abort_code(), kAbortNotExpedited);
  EXPECT_EQ(last(), (std::vector<uint8_t>{0x80, 0x08, 0x10, 0, 0x01, 0x00, 0x04, 0x05}));
  client.download({0x6060, 0}, 3, 1, 0);
  answer({0x4F, 0x60, 0x60, 0, 3, 0, 0, 0});
  EXPECT_EQ(client.state(), SdoState::kAborted) << "an answer to a read that was not asked";
}

TEST_F(SdoTest, Silence_TimesOutAndTellsTheNode) {
  client.upload({0x6061, 0}, 0);
  client.poll(499 * kMs);
  EXPECT_EQ(client.state(), SdoState::kBusy);
  client.poll(500 * kMs);
  EXPECT_EQ(client.state(), SdoState::kTimeout);
  EXPECT_EQ(last(), (std::vector<uint8_t>{0x80, 0x61, 0x60, 0, 0x00, 0x00, 0x04, 0x05}));
}

TEST_F(SdoTest, BusThatRefuses_IsTriedUntilTheTimeIsOver) {
  bus.refuse = 3;
  client.upload({0x6061, 0}, 0);
  answer({0x43, 0x61, 0x60, 0, 1, 2, 3, 4});
  EXPECT_EQ(client.state(), SdoState::kBusy) << "an answer before the question";
  for (int64_t ms = 1; ms <= 3; ++ms) client.poll(ms * kMs);
  EXPECT_EQ(bus.sent().size(), 1U);
  answer({0x43, 0x61, 0x60, 0, 1, 2, 3, 4});
  EXPECT_EQ(client.state(), SdoState::kDone);
  bus.refuse = 1'000;
  client.upload({0x6061, 0}, 0);
  client.poll(500 * kMs);
  EXPECT_EQ(client.state(), SdoState::kTimeout);
}

}  // namespace
}  // namespace roomcal::drivers::cia402
