#include "tools/sweep/wall_offsets.h"

#include <gtest/gtest.h>

#include "tests/tools/refusal.h"
#include "tests/truth/lidar_box.h"
#include "tests/truth/random.h"

namespace roomcal::tools {
namespace {

TEST(WallOffsets, BoxWithBiasedLasers_FindsTheBiases) {
  truth::Random random(3);
  std::vector<double> bias_m(16);
  double mean_m = 0;
  for (double& bias : bias_m) mean_m += (bias = 0.01 * random.normal()) / 16;
  Vlp16Stream stream;
  auto returns = truth::box_returns(stream, 4 * stream.firings_per_turn(), {-1.2, -2.2, -30}, {1.8, 1.8, 30}, bias_m);
  for (Vlp16Return& r : returns) r.range_m += 0.015 * random.normal();
  LoadRequest request;
  request.model = "vlp16";
  const Recording recording = load_sweeps("box", make_vlp16_pcap(stream, returns, 0), request);
  const WallOffsets offsets = wall_offsets(recording);
  EXPECT_GE(offsets.walls.size(), 2U);
  ASSERT_EQ(offsets.beams.size(), 16U);
  for (const BeamOffset& beam : offsets.beams) {
    EXPECT_NEAR(beam.mean_mm, 1e3 * (bias_m[beam.beam] - mean_m), 1.5) << "beam " << beam.beam;
    EXPECT_NEAR(beam.noise_mm, 15, 2);
    EXPECT_LT(beam.spread_mm, 2);
  }
}

TEST(WallOffsets, NothingFlat_IsRefused) {
  truth::Random random(4);
  Vlp16Stream stream;
  std::vector<Vlp16Return> returns(3 * stream.firings_per_turn() * kVlp16Lasers);
  for (Vlp16Return& r : returns) r.range_m = random.uniform(1, 40);
  LoadRequest request;
  request.model = "vlp16";
  const Recording recording = load_sweeps("fog", make_vlp16_pcap(stream, returns, 0), request);
  EXPECT_TRUE(test::contains(test::refusal([&] { static_cast<void>(wall_offsets(recording)); }), "no flat wall"));
}

}  // namespace
}  // namespace roomcal::tools
