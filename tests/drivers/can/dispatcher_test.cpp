#include "drivers/can/dispatcher.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/fakes/fake_can_bus.h"
#include "tests/fakes/manual_clocks.h"

namespace roomcal::drivers {
namespace {

struct Ear final : CanListener {
  explicit Ear(std::vector<CanId> of) : wanted(std::move(of)) {}
  std::span<const CanId> ids() const override { return wanted; }
  void hear(const ports::CanMessage& message, const Arrival& arrival) override {
    heard.push_back(message.id);
    arrivals.push_back(arrival);
  }
  std::vector<CanId> wanted;
  std::vector<uint32_t> heard;
  std::vector<Arrival> arrivals;
};

ports::CanMessage message_of(uint32_t id, bool extended = false) {
  ports::CanMessage message;
  message.id = id;
  message.extended = extended;
  return message;
}

struct DispatcherTest : testing::Test {
  fakes::ManualClocks clocks;
  fakes::FakeCanBus bus{clocks};
  Dispatcher dispatcher{bus, clocks};
};

TEST_F(DispatcherTest, Messages_ReachThoseWhoWantThem) {
  Ear one({{1, false}, {2, false}}), two({{2, false}, {2, true}});
  ASSERT_TRUE(dispatcher.add(one).ok());
  ASSERT_TRUE(dispatcher.add(two).ok());
  EXPECT_EQ(dispatcher.ids().size(), 3U);
  for (const auto& message : {message_of(1), message_of(2), message_of(2, true), message_of(3)}) bus.deliver(message);
  EXPECT_EQ(dispatcher.poll(), 4U);
  EXPECT_EQ(one.heard, (std::vector<uint32_t>{1, 2}));
  EXPECT_EQ(two.heard, (std::vector<uint32_t>{2, 2}));
}

TEST_F(DispatcherTest, Arrival_LiesBetweenTheLastEmptyQueueAndNow) {
  Ear ear({{1, false}});
  ASSERT_TRUE(dispatcher.add(ear).ok());
  bus.deliver(message_of(1));
  dispatcher.poll();
  EXPECT_LT(ear.arrivals[0].earliest_ns, -1'000'000'000'000) << "nothing is known of what came before the first look";
  const int64_t empty_ns = clocks.now_ns();
  clocks.advance(7'000'000);
  bus.deliver(message_of(1));
  clocks.advance(400'000'000);  // the loop hangs while the message waits
  clocks.step_realtime(-1'000'000'000);
  dispatcher.poll();
  EXPECT_EQ(ear.arrivals[1].earliest_ns, empty_ns);
  EXPECT_EQ(ear.arrivals[1].latest_ns, clocks.now_ns());
}

TEST_F(DispatcherTest, FloodedBus_IsLeftAfterABoundedNumber) {
  Ear ear({{1, false}});
  ASSERT_TRUE(dispatcher.add(ear).ok());
  dispatcher.poll();
  const int64_t empty_ns = clocks.now_ns();
  for (int i = 0; i < 1000; ++i) bus.deliver(message_of(1));
  clocks.advance(5);
  EXPECT_EQ(dispatcher.poll(), 512U);
  clocks.advance(5);
  EXPECT_EQ(dispatcher.poll(), 488U);
  EXPECT_EQ(ear.arrivals.back().earliest_ns, empty_ns) << "the queue was not empty in between";
}

TEST_F(DispatcherTest, TooManyIdentifiers_AreRefusedWhole) {
  std::vector<CanId> many;
  for (uint32_t id = 0; id <= kMaxCanIds; ++id) many.push_back({id, false});
  Ear crowd(many), one({{700, false}});
  EXPECT_EQ(dispatcher.add(crowd).code(), StatusCode::kCapacity);
  EXPECT_TRUE(dispatcher.ids().empty());
  for (std::size_t i = 0; i < kMaxListeners; ++i) EXPECT_TRUE(dispatcher.add(one).ok());
  EXPECT_EQ(dispatcher.add(one).code(), StatusCode::kCapacity);
  EXPECT_EQ(dispatcher.ids().size(), 1U);
}

}  // namespace
}  // namespace roomcal::drivers
