#include "drivers/evdev/edge_filter.h"

#include <gtest/gtest.h>

namespace roomcal::drivers {
namespace {

TEST(EdgeFilter, Changes_AreEdges) {
  EdgeFilter filter;
  filter.start(false);
  ports::ButtonEdge edge;
  EXPECT_TRUE(filter.take(true, 5, edge));
  EXPECT_TRUE(edge.down);
  EXPECT_EQ(edge.stamp_ns, 5);
  EXPECT_FALSE(filter.take(true, 6, edge));
  EXPECT_TRUE(filter.take(false, 7, edge));
  EXPECT_FALSE(edge.down);
  EXPECT_FALSE(filter.take(false, 8, edge));
}

TEST(EdgeFilter, HeldAtTheStart_NothingUntilReleased) {
  EdgeFilter filter;
  filter.start(true);
  ports::ButtonEdge edge;
  EXPECT_FALSE(filter.take(true, 1, edge));
  EXPECT_FALSE(filter.take(false, 2, edge));
  EXPECT_TRUE(filter.take(true, 3, edge));
  EXPECT_TRUE(filter.take(false, 4, edge));
}

}  // namespace
}  // namespace roomcal::drivers
