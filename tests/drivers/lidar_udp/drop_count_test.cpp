#include "drivers/lidar_udp/drop_count.h"

#include <gtest/gtest.h>

namespace roomcal::drivers {
namespace {

TEST(DropCount, ReadingsOfEitherKind_GiveOneCount) {
  DropCount count;
  count.observe(0);
  count.observe(3);   // beside a packet
  count.observe(10);  // of the socket
  count.observe(5);   // of a packet that was queued before that
  count.observe(10);
  EXPECT_EQ(count.total(), 10U);
  count.observe(12);
  EXPECT_EQ(count.total(), 12U);
}

TEST(DropCount, CounterStartsAgain_LosesNothing) {
  DropCount count;
  uint32_t reading = 0;
  uint64_t total = 0;
  for (int i = 0; i < 7; ++i) {
    reading += 0x60000000;
    total += 0x60000000;
    count.observe(reading);
  }
  EXPECT_EQ(count.total(), total);
  count.observe(reading + 1);
  EXPECT_EQ(count.total(), total + 1);
}

}  // namespace
}  // namespace roomcal::drivers
