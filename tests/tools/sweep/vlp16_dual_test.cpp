// Dual return of the VLP-16: by the manual, both returns of a firing have one azimuth, and lasers turn on towards the
// next pair of blocks. The reference cloud of the office capture was made by a decoder that does otherwise; this file
// shows that the difference is exactly that.
#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "runtime/lidar/point_sink.h"
#include "runtime/lidar/velodyne.h"
#include "tests/tools/sweep/captures.h"
#include "tools/common/files.h"
#include "tools/sweep/cloud_files.h"
#include "tools/sweep/compare.h"
#include "tools/sweep/load_sweeps.h"
#include "tools/sweep/pcap.h"

namespace roomcal::tools {
namespace {

using lidar::Bytes;

/// Azimuth and turn that the reference's decoder (tier4/nebula, vlp16_decoder.cpp, as of the cloud's making) gives the
/// blocks of a dual-return packet: an odd block takes the azimuth of the next pair, block 10 and odd blocks do not
/// turn.
struct ReferenceBlock {
  int azimuth_cdeg = 0, turn_cdeg = 0;
};

std::array<ReferenceBlock, 12> reference_blocks(Bytes packet) {
  std::array<ReferenceBlock, 12> blocks;
  const auto azimuth = [&](std::size_t block) { return static_cast<int>(lidar::le16(packet, block * 100 + 2)); };
  int next = azimuth(0), last_turn = 0;
  for (std::size_t block = 0; block < 12; ++block) {
    blocks[block].azimuth_cdeg = next;
    if (block < 10) {
      next = azimuth(block + 2);
      last_turn = lidar::forward_step_cdeg(blocks[block].azimuth_cdeg, next);
      blocks[block].turn_cdeg = last_turn;
    } else {
      blocks[block].turn_cdeg = block == 10 ? 0 : last_turn;
    }
  }
  return blocks;
}

void add_reference_points(Bytes packet, const lidar::Calibration& calibration, LoadedSweep& sweep) {
  const auto blocks = reference_blocks(packet);
  for (std::size_t block = 0; block < 12; ++block) {
    for (std::size_t channel = 0; channel < 32; ++channel) {
      const std::size_t at = block * 100 + 4 + channel * 3;
      const uint16_t range = lidar::le16(packet, at);
      const bool again = block % 2 == 1 && lidar::le16(packet, at - 100) == range;
      if (range == 0 || again) continue;
      const double part = lidar::velodyne_channel_us(lidar::Model::kVlp16, channel) / 110.592;
      const double cdeg = std::round(blocks[block].azimuth_cdeg + blocks[block].turn_cdeg * part);
      const lidar::Direction direction = lidar::Direction::of(lidar::cdeg_to_rad(cdeg));
      lidar::SweepPoint point;
      lidar::place_from_y(calibration.beams[channel % 16], calibration.trig[channel % 16], direction, 0.002 * range,
                          point);
      sweep.points.push_back(point);
    }
  }
}

struct Office {
  LoadedSweep reference;
  std::vector<LoadedSweep> by_manual, by_reference;
};

Office read_office(const std::filesystem::path& capture) {
  Office office;
  const AlignedBytes cloud = read_bytes(capture.parent_path() / "velodyne_vlp16.ref.pcd");
  office.reference = read_cloud("reference", cloud.span());
  LoadRequest request;
  request.file = capture;
  request.model = "vlp16";
  const Recording recording = load_sweeps(request);
  office.by_manual = recording.sweeps;
  const AlignedBytes bytes = read_bytes(capture);
  PcapReader reader("capture", bytes.span());
  office.by_reference.resize(1);
  Datagram datagram;
  while (reader.next(datagram)) add_reference_points(datagram.payload, recording.calibration, office.by_reference[0]);
  return office;
}

TEST(Vlp16Dual, TheReferencesArithmetic_ReproducesItsCloud) {
  ROOMCAL_CAPTURE(capture, "lidar/velodyne/velodyne_vlp16.pcap");
  const Office office = read_office(capture);
  const std::vector<double> d = nearest_distances_m(office.reference.view(), office.by_reference, true);
  EXPECT_EQ(d.size(), 14'831U);
  EXPECT_LT(d.back(), 0.002) << "what rounding of azimuths to 0.01 degree leaves";
}

TEST(Vlp16Dual, TheManualsArithmetic_DiffersFromTheReferenceAsItsDefectTells) {
  ROOMCAL_CAPTURE(capture, "lidar/velodyne/velodyne_vlp16.pcap");
  const Office office = read_office(capture);
  const std::vector<double> d = nearest_distances_m(office.reference.view(), office.by_manual, true);
  const auto beyond = std::count_if(d.begin(), d.end(), [](double distance) { return distance > 1e-3; });
  EXPECT_NEAR(static_cast<double>(beyond) / static_cast<double>(d.size()), 0.134, 0.01);
  EXPECT_LT(d[d.size() / 2], 2e-4) << "first returns, blocks 0 to 8: the same arithmetic";
  // An odd block's azimuth is off by up to one turn of a pair, 0.4 degree, and so is block 10's last laser.
  EXPECT_LT(d.back(), 14.7 * 0.0070);
}

TEST(Vlp16Dual, BothReturnsOfAFiring_LieOnOneRay) {
  ROOMCAL_CAPTURE(capture, "lidar/velodyne/velodyne_vlp16.pcap");
  const Office office = read_office(capture);
  std::size_t pairs = 0;
  for (const LoadedSweep& sweep : office.by_manual) {
    for (std::size_t i = 1; i < sweep.points.size(); ++i) {
      const lidar::SweepPoint &first = sweep.points[i - 1], &second = sweep.points[i];
      if (second.return_index != 1) continue;
      ASSERT_EQ(first.beam, second.beam);
      ASSERT_EQ(first.offset_ns, second.offset_ns);
      ASSERT_EQ(first.azimuth_rad, second.azimuth_rad);
      ++pairs;
    }
  }
  EXPECT_GT(pairs, 500U);
}

}  // namespace
}  // namespace roomcal::tools
