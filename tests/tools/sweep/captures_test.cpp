// Real captures against what others made of them, or against what their bytes say.
#include "tests/tools/sweep/captures.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "tools/common/files.h"
#include "tools/sweep/cloud_files.h"
#include "tools/sweep/compare.h"
#include "tools/sweep/load_sweeps.h"
#include "tools/sweep/wall_offsets.h"

namespace roomcal::tools {
namespace {

namespace fs = std::filesystem;

Recording load(const fs::path& file, const std::string& model, const fs::path& calibration = {}) {
  LoadRequest request;
  request.file = file;
  request.model = model;
  request.calibration = calibration;
  return load_sweeps(request);
}

std::size_t points_of(const Recording& recording) {
  std::size_t points = 0;
  for (const LoadedSweep& sweep : recording.sweeps) points += sweep.points.size();
  return points;
}

std::size_t whole_sweeps(const Recording& recording) {
  std::size_t whole = 0;
  for (const LoadedSweep& sweep : recording.sweeps) whole += (sweep.facts.flags & lidar::kSweepPartial) == 0;
  return whole;
}

void expect_equal_cloud(const fs::path& capture, const std::string& model, const fs::path& csv,
                        const fs::path& reference, std::size_t packets) {
  const Recording recording = load(capture, model, csv);
  EXPECT_EQ(recording.report.counters.packets, packets);
  EXPECT_EQ(recording.report.counters.lost, 0U);
  EXPECT_TRUE(recording.report.refused.empty());
  EXPECT_TRUE(recording.report.warnings.empty());
  const AlignedBytes bytes = read_bytes(reference);
  const LoadedSweep cloud = read_cloud("reference", bytes.span());
  const std::vector<double> distances = nearest_distances_m(cloud.view(), recording.sweeps, false);
  EXPECT_LT(distances.back(), 1e-4) << "of " << distances.size() << " points";
}

TEST(Captures, Xt32_EqualsItsReferenceToATenthOfAMillimetre) {
  ROOMCAL_CAPTURE(capture, "lidar/hesai/hesai_xt32.pcap");
  const fs::path lidar = capture.parent_path().parent_path();
  expect_equal_cloud(capture, "xt32", lidar / "calibration/PandarXT32.csv", lidar / "hesai/hesai_xt32.ref.pcd", 2000);
}

TEST(Captures, Qt64_EqualsItsReferenceToATenthOfAMillimetre) {
  ROOMCAL_CAPTURE(capture, "lidar/hesai/hesai_qt64.pcap");
  const fs::path lidar = capture.parent_path().parent_path();
  expect_equal_cloud(capture, "qt64", lidar / "calibration/PandarQT64.csv", lidar / "hesai/hesai_qt64.ref.pcd", 1200);
}

void expect_equal_digests(const fs::path& capture) {
  LoadRequest request;
  request.file = capture;
  request.model = "ouster";
  request.calibration = fs::path(capture).replace_extension(".json");
  const Recording recording = load_sweeps(request);
  EXPECT_EQ(recording.sweeps.size(), 1U);
  EXPECT_EQ(recording.report.other_packets.at("imu"), 10U);
  EXPECT_TRUE(recording.report.warnings.empty()) << recording.report.warnings.front();
  const Comparison comparison =
      compare(recording, request, capture.parent_path() / (capture.stem().string() + "_digest.json"));
  EXPECT_GE(comparison.fields.size(), 10U);
  for (const auto& [field, same] : comparison.fields) EXPECT_TRUE(same) << field;
}

TEST(Captures, OusterLowBandwidth_EveryFieldDigestIsEqual) {
  ROOMCAL_CAPTURE(capture, "lidar/ouster/OS-0-128-U1_v2.3.0_1024x10.pcap");
  expect_equal_digests(capture);
}

TEST(Captures, OusterDualReturn_EveryFieldDigestIsEqual) {
  ROOMCAL_CAPTURE(capture, "lidar/ouster/OS-0-32-U1_v2.2.0_1024x10.pcap");
  expect_equal_digests(capture);
}

TEST(Captures, OusterOfAnotherUnit_IsNamed) {
  ROOMCAL_CAPTURE(capture, "lidar/ouster/OS-1-128_v2.3.0_1024x10_lb_n3.pcap");
  const fs::path folder = capture.parent_path();
  EXPECT_TRUE(load(capture, "os1", folder / "OS-1-128_v2.3.0_1024x10.json").report.warnings.empty());
  const Recording other = load(capture, "os1", folder / "OS-0-128-U1_v2.3.0_1024x10.json");
  ASSERT_EQ(other.sweeps.size(), 3U);
  EXPECT_NE(other.sweeps[0].facts.flags & lidar::kSweepOtherSensor, 0U);
  ASSERT_FALSE(other.report.warnings.empty());
  EXPECT_NE(other.report.warnings[0].find("another serial number"), std::string::npos);
}

// The Helios capture was cut into datagrams at the wrong places by whoever converted it: every 1256th to 1264th byte is
// missing, and a tenth of the packets. What is there, must be where its reference has it.
TEST(Captures, Helios_WhatIsThereIsWithinAMillimetreOfItsReference) {
  ROOMCAL_CAPTURE(capture, "lidar/robosense/robosense_helios16p.pcap");
  Recording recording = load(capture, "helios16p");
  EXPECT_EQ(recording.report.realigned, 600U);
  const AlignedBytes bytes = read_bytes(capture.parent_path() / "robosense_helios16p.ref0.pcd");
  const std::vector<LoadedSweep> reference = {read_cloud("reference", bytes.span())};
  // The reference is the first turn, cut at azimuth 0, ranges from 0.2 m.
  LoadedSweep& first = recording.sweeps[0];
  std::erase_if(first.points, [](const lidar::SweepPoint& p) { return p.range_m < 0.2F || p.azimuth_rad > 6.2F; });
  const std::vector<double> distances = nearest_distances_m(first.view(), reference, false);
  const auto near = std::count_if(distances.begin(), distances.end(), [](double d) { return d < 1e-3; });
  EXPECT_GT(distances.size(), 10'000U);
  EXPECT_GT(static_cast<double>(near), 0.98 * static_cast<double>(distances.size()));
  EXPECT_LT(distances[distances.size() * 9 / 10], 1e-4);
}

TEST(Captures, VelodyneCorridor_FiftyTurnsAndStableBeamOffsets) {
  ROOMCAL_CAPTURE(capture, "lidar/velodyne/veloview_vlp-16-test-90deg-1-50-frames.pcap");
  const Recording recording = load(capture, "vlp16");
  EXPECT_EQ(recording.report.counters.packets, 1902U);
  EXPECT_EQ(recording.report.other_packets.at("position"), 367U);
  EXPECT_EQ(recording.report.counters.lost, 0U);
  EXPECT_EQ(points_of(recording), 700'400U) << "returns that are not zero, counted in the bytes";
  EXPECT_EQ(whole_sweeps(recording), 50U);
  ASSERT_EQ(recording.report.warnings.size(), 1U) << "an early unit with the factory byte of an HDL-32E";
  EXPECT_NE(recording.report.warnings[0].find("0x21"), std::string::npos);
  const WallOffsets walls = wall_offsets(recording);
  ASSERT_EQ(walls.beams.size(), 16U);
  for (const BeamOffset& beam : walls.beams) EXPECT_LT(beam.spread_mm, 2.0) << "beam " << beam.beam;
}

TEST(Captures, RenderedRobot_TenTurnsAndTheBiasesOfItsLasers) {
  ROOMCAL_CAPTURE(capture, "room-a/robot/lidar0.pcap");
  const Recording recording = load(capture, "vlp16");
  EXPECT_EQ(points_of(recording), 288'399U);
  EXPECT_EQ(whole_sweeps(recording), 10U);
  const auto truth = nlohmann::json::parse(read_text(capture.parent_path() / "truth.json"));
  const auto bias_m = truth["lidars"]["lidar0"]["laser_bias_m"].get<std::vector<double>>();
  double mean_m = 0;
  for (const double b : bias_m) mean_m += b / 16;
  double squares = 0;
  for (const BeamOffset& beam : wall_offsets(recording).beams)
    squares += std::pow(beam.mean_mm - 1e3 * (bias_m[beam.beam] - mean_m), 2) / 16;
  EXPECT_LT(std::sqrt(squares), 1.5) << "pillar and markers stand before the walls";
}

}  // namespace
}  // namespace roomcal::tools
