#include "tools/sheets/ring_ratios.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/tools/refusal.h"

namespace roomcal::tools {
namespace {

void expect_equal(const RingRadii& a, const RingRadii& b) {
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-12) << i;
}

TEST(RingRatios, PercentFractionAndIdentity_AreTheSame) {
  const RingRadii expected{1, 0.85, 0.70, 0.55, 0.40, 0.25};
  expect_equal(parse_ratios("85,70,55,40,25"), expected);
  expect_equal(parse_ratios("0.85,0.70,0.55,0.4,0.25"), expected);
  expect_equal(parse_ratios("id31"), expected);
  expect_equal(parse_ratios("id0"), {1, 0.9, 0.8, 0.7, 0.6, 0.5});
}

TEST(RingRatios, WholeBank_IsAccepted) {
  for (std::size_t id = 0; id < kCctag3Percent.size(); ++id) {
    const RingRadii radii = parse_ratios(fmt::format("id{}", id));
    expect_equal(radii, cctag3_radii(id));
    expect_equal(parse_ratios(fmt::format("{}", fmt::join(kCctag3Percent[id], ","))), radii);
  }
}

TEST(RingRatios, NotDescending_NamesTheNumber) {
  for (const auto& [text, part] : {std::pair{"85,70,70,40,25", "70 is not below"},
                                   {"70,85,55,40,25", "85 is not below"},
                                   {"0.85,0.7,0.55,0.6,0.25", "0.6 is not below"},
                                   {"100,70,55,40,25", "100 is not below"}}) {
    const std::string message = test::refusal([text = text] { static_cast<void>(parse_ratios(text)); });
    EXPECT_TRUE(test::contains(message, part)) << text << ": " << message;
  }
}

TEST(RingRatios, OtherNonsense_IsRefused) {
  for (const char* text : {"", "85", "85,70,55,40", "85,70,55,40,25,10", "85,70,x,40,25", "nan,70,55,40,25", "id32",
                           "id-1", "id1.5", "id", "85,83,55,40,25", "85,70,55,40,5", "-85,-90,-95,-98,-99"}) {
    EXPECT_TRUE(test::contains(test::refusal([&] { static_cast<void>(parse_ratios(text)); }), "--ratios")) << text;
  }
}

}  // namespace
}  // namespace roomcal::tools
