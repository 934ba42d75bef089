#include "tools/simulate/vlp16_packets.h"

#include <gtest/gtest.h>

#include "runtime/lidar/packet.h"
#include "tests/truth/lidar_box.h"
#include "tests/truth/random.h"
#include "tools/sweep/load_sweeps.h"

namespace roomcal::tools {
namespace {

const Vec3 kLow(-1.4, -2.1, -1.1), kHigh(1.6, 1.9, 1.6);

Recording decode(const std::vector<std::byte>& pcap) {
  LoadRequest request;
  request.model = "vlp16";
  return load_sweeps("simulated", pcap, request);
}

TEST(Vlp16Packets, ThroughTheDecoder_EveryPointComesBackWhereItWas) {
  Vlp16Stream stream;
  stream.first_azimuth_rad = 2.5;
  stream.first_ns = 3'599'950'000'000;  // the hour ends within the recording
  const std::size_t firings = 2 * stream.firings_per_turn();
  const auto returns = truth::box_returns(stream, firings, kLow, kHigh);
  const Recording recording = decode(make_vlp16_pcap(stream, returns, 1'700'000'000'000'000'000));
  EXPECT_TRUE(recording.report.warnings.empty());
  std::size_t points = 0;
  for (const LoadedSweep& sweep : recording.sweeps) {
    for (const lidar::SweepPoint& p : sweep.points) {
      const int64_t after_ns = sweep.facts.stamp.ns + p.offset_ns - stream.first_ns;
      const auto firing = static_cast<std::size_t>(
          std::llround((1e-3 * static_cast<double>(after_ns) - stream.time_us(0, p.beam)) / 55.296));
      const double azimuth = stream.azimuth_rad(firing, p.beam);
      // Stamps go by microseconds, azimuths by hundredths of a degree, ranges by 2 mm.
      ASSERT_NEAR(std::remainder(static_cast<double>(p.azimuth_rad) - azimuth, 2 * kPi), 0, deg_to_rad(0.012));
      const Vlp16Return& truth_return = returns[firing * kVlp16Lasers + p.beam];
      ASSERT_NEAR(static_cast<double>(p.range_m), truth_return.range_m, 0.0011);
      ASSERT_EQ(p.reflectivity, truth_return.reflectivity);
      const Vec3 at =
          static_cast<double>(p.range_m) *
          truth::vlp16_ray_lidar(static_cast<double>(p.azimuth_rad), recording.calibration.beams[p.beam].elevation_rad);
      ASSERT_LT((Vec3(static_cast<double>(p.x_m), static_cast<double>(p.y_m), static_cast<double>(p.z_m)) - at).norm(),
                1e-5);
      ++points;
    }
  }
  EXPECT_EQ(points, firings / kVlp16FiringsPerPacket * kVlp16FiringsPerPacket * kVlp16Lasers);
}

TEST(Vlp16Packets, DualReturn_GivesBothReturnsOnOneRay) {
  Vlp16Stream stream;
  stream.return_mode = lidar::kVelodyneDual;
  auto returns = truth::box_returns(stream, stream.firings_per_turn(), kLow, kHigh);
  for (std::size_t i = 0; i < returns.size(); i += 3) {
    returns[i].second_range_m = returns[i].range_m + 0.5;
    returns[i].second_reflectivity = 3;
  }
  const Recording recording = decode(make_vlp16_pcap(stream, returns, 0));
  EXPECT_EQ(recording.report.returns, 2);
  std::size_t seconds = 0;
  for (const LoadedSweep& sweep : recording.sweeps) {
    for (std::size_t i = 0; i < sweep.points.size(); ++i) {
      const lidar::SweepPoint& p = sweep.points[i];
      if (p.return_index == 0) continue;
      ASSERT_EQ(p.azimuth_rad, sweep.points[i - 1].azimuth_rad);
      ASSERT_NEAR(static_cast<double>(p.range_m - sweep.points[i - 1].range_m), 0.5, 0.0021);
      ++seconds;
    }
  }
  const std::size_t whole =
      returns.size() / (kVlp16FiringsPerPacket / 2 * kVlp16Lasers) * (kVlp16FiringsPerPacket / 2 * kVlp16Lasers);
  EXPECT_EQ(seconds, (whole + 2) / 3);
}

TEST(Vlp16Packets, TenTurnsFromAnyAzimuth_AreTenWholeSweeps) {
  Vlp16Stream stream;
  stream.first_azimuth_rad = 5.1;
  const auto returns = truth::box_returns(stream, 10 * stream.firings_per_turn() + 30, kLow, kHigh);
  const Recording recording = decode(make_vlp16_pcap(stream, returns, 0));
  std::size_t whole = 0;
  for (const LoadedSweep& sweep : recording.sweeps) whole += sweep.facts.flags == 0;
  EXPECT_EQ(whole, 10U);
}

}  // namespace
}  // namespace roomcal::tools
