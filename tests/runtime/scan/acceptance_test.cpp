#include "runtime/scan/acceptance.h"

#include <string_view>

#include <gtest/gtest.h>

namespace roomcal::scan {
namespace {

TEST(Shares, CountsOfAPass_AreShares) {
  RangeSums sums;
  sums.valid = 1000;
  sums.mapped = 800;
  sums.inliers = 600;
  sums.beyond = 80;
  sums.inlier_squares = 600;
  sums.beam[3].points = 1000;
  RangeState state;
  state.offset_m[3] = 0.02;
  state.offset_m[4] = 1;  // of a beam without points
  sums.face[0] = {600, 580};
  sums.face[1] = {200, 20};
  const FitShares shares = shares_of(sums, {}, 0.03, state);
  EXPECT_DOUBLE_EQ(shares.mapped, 0.8);
  EXPECT_DOUBLE_EQ(shares.explained, 0.75);
  EXPECT_DOUBLE_EQ(shares.beyond, 0.1);
  EXPECT_DOUBLE_EQ(shares.contradicted, 0.25);
  EXPECT_DOUBLE_EQ(shares.scatter, 2);
  EXPECT_DOUBLE_EQ(shares.offsets, 2);
}

TEST(WhyRefused, EachShareBeyondItsLimit_HasItsOwnReason) {
  const FitShares good{0.9, 0.95, 0.01, 0.02, 1, 1};
  EXPECT_EQ(std::string_view(why_refused(good, {})), "");
  FitShares bad = good;
  bad.mapped = 0.2;
  EXPECT_NE(std::string_view(why_refused(bad, {})).find("nothing that the map knows"), std::string_view::npos);
  bad = good;
  bad.beyond = 0.2;
  EXPECT_NE(std::string_view(why_refused(bad, {})).find("behind the map's walls"), std::string_view::npos);
  bad = good;
  bad.explained = 0.5;
  EXPECT_NE(std::string_view(why_refused(bad, {})).find("too few points"), std::string_view::npos);
  bad = good;
  bad.contradicted = 0.4;
  EXPECT_NE(std::string_view(why_refused(bad, {})).find("stands elsewhere"), std::string_view::npos);
  bad = good;
  bad.scatter = 2;
  EXPECT_NE(std::string_view(why_refused(bad, {})).find("scatter"), std::string_view::npos);
  bad = good;
  bad.offsets = 4;
  EXPECT_NE(std::string_view(why_refused(bad, {})).find("beam offsets"), std::string_view::npos);
}

TEST(Shares, EmptySums_AreNoRoom) { EXPECT_NE(std::string_view(why_refused(shares_of({}, {}, 0.015, {}), {})), ""); }

}  // namespace
}  // namespace roomcal::scan
