// From the packets of a recording to the LiDAR's place in the room: no heap call, before arming or after.

#include <vector>

#include <gtest/gtest.h>

#include "runtime/lidar/sweep_builder.h"
#include "runtime/map/sample_surface.h"
#include "runtime/scan/locate_by_gicp.h"
#include "tests/budget/heap_guard.h"
#include "tests/runtime/scan/baked_room.h"
#include "tests/truth/lidar_box.h"
#include "tests/truth/random.h"
#include "tools/simulate/make_room.h"
#include "tools/simulate/ray.h"
#include "tools/sweep/pcap.h"

namespace roomcal {
namespace {

constexpr int kTurns = 2;
const SE3 kT_room_lidar{so3_exp(Vec3(0.25, 0.15, 0.7)), Vec3(1.1, 1.6, 1.2)};

/// A VLP-16 in a simulated room, as a pcap file's bytes.
std::vector<std::byte> record_vlp16(const tools::Scene& room) {
  const lidar::Calibration unit = lidar::built_in_calibration(lidar::Model::kVlp16).value();
  tools::Vlp16Stream stream;
  truth::Random random(3);
  std::vector<tools::Vlp16Return> returns;
  for (std::size_t firing = 0; firing < kTurns * stream.firings_per_turn(); ++firing) {
    for (std::size_t laser = 0; laser < tools::kVlp16Lasers; ++laser) {
      const Vec3 ray_lidar = truth::vlp16_ray_lidar(stream.azimuth_rad(firing, laser), unit.beams[laser].elevation_rad);
      const tools::Hit hit = tools::cast_ray(room, kT_room_lidar.t, kT_room_lidar.R * ray_lidar);
      returns.push_back({hit.distance + 0.015 * random.normal(), 40, 0, 0});
    }
  }
  return tools::make_vlp16_pcap(stream, returns, 0);
}

std::vector<std::vector<std::byte>> payloads_of(const std::vector<std::byte>& pcap) {
  std::vector<std::vector<std::byte>> payloads;
  tools::PcapReader reader("simulated", pcap);
  for (tools::Datagram datagram; reader.next(datagram);) {
    payloads.emplace_back(datagram.payload.begin(), datagram.payload.end());
  }
  return payloads;
}

TEST(LidarHeap, FromPacketsToThePlaceInTheRoom_NoCall) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer brings its own allocator";
#endif
  const scan::test::BakedRoom room(tools::make_room({.seed = 5, .pillar = true}));
  const std::vector<std::vector<std::byte>> payloads = payloads_of(record_vlp16(room.scene));
  const lidar::Calibration unit = lidar::built_in_calibration(lidar::Model::kVlp16).value();
  const lidar::SweepOptions cut = {.capacity = 32'000};
  std::vector<std::byte> permanent_bytes(scan::Surface::bytes(room.map.plane_count(), room.map.marker_count()) +
                                         lidar::SweepBuilder::arena_bytes(cut) +
                                         scan::GicpTarget::bytes(map::surface_point_count(room.map)));
  std::vector<std::byte> scratch_bytes(std::max(
      {scan::locate_scratch_bytes(), scan::locate_by_gicp_scratch_bytes(), scan::test::BakedRoom::kScratchBytes}));
  scan::PosePrior prior;
  prior.T_room_lidar = kT_room_lidar * se3_exp((Vec6() << 0.1, -0.1, 0.05, 0.05, -0.05, 0.05).finished());
  prior.cov = 0.02 * Mat66::Identity();
  Arena permanent{permanent_bytes}, scratch{scratch_bytes};
  scan::Location location, by_gicp;
  std::size_t points = 0, before_arming = 0, decoding = 0, locating = 0;
  bool pushed = true;
  Status built, located, registered;
  {
    const budget::HeapGuard guard;
    const Result<scan::Surface> surface = scan::Surface::build(room.map, {}, permanent, scratch);
    Result<lidar::SweepBuilder> builder = lidar::SweepBuilder::create(unit, cut, permanent);
    const Result<scan::GicpTarget> dense = scan::GicpTarget::build(room.map, 0, permanent);
    permanent.seal();
    before_arming = guard.calls();
    built = !surface.ok() ? surface.status() : builder.ok() ? dense.status() : builder.status();
    if (built.ok()) {
      for (const std::vector<std::byte>& payload : payloads) {
        pushed = pushed && builder.value().push(payload).ok();
        if (builder.value().ready()) break;
      }
      if (!builder.value().ready()) builder.value().finish();
      decoding = guard.calls() - before_arming;
      points = builder.value().sweep().points.size();
      located = scan::locate(surface.value(), {&builder.value().sweep(), 1}, {}, &prior, {}, scratch, location);
      registered = scan::locate_by_gicp(surface.value(), dense.value(), {&builder.value().sweep(), 1}, {}, &prior, {},
                                        {}, scratch, by_gicp);
      locating = guard.calls() - before_arming - decoding;
    }
  }
  ASSERT_TRUE(built.ok()) << built.detail();
  EXPECT_TRUE(pushed);
  EXPECT_GT(points, 25'000U);
  ASSERT_TRUE(located.ok()) << located.detail();
  EXPECT_EQ(location.outcome, scan::LocateOutcome::kLocated) << location.reason;
  EXPECT_LT((location.T_room_lidar.t - kT_room_lidar.t).norm(), 0.005);
  ASSERT_TRUE(registered.ok()) << registered.detail();
  EXPECT_EQ(by_gicp.outcome, scan::LocateOutcome::kLocated) << by_gicp.reason;
  EXPECT_LT((by_gicp.T_room_lidar.t - kT_room_lidar.t).norm(), 0.03);
  EXPECT_EQ(before_arming, 0U);
  EXPECT_EQ(decoding, 0U);
  EXPECT_EQ(locating, 0U);
  EXPECT_EQ(permanent.refusals() + scratch.refusals(), 0U);
}

}  // namespace
}  // namespace roomcal
