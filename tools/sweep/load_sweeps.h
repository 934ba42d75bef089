#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "runtime/lidar/calibration.h"
#include "runtime/lidar/sweep.h"
#include "runtime/lidar/sweep_builder.h"
#include "tools/sweep/pcap.h"

namespace roomcal::tools {

/// A sweep in host memory.
struct LoadedSweep {
  std::vector<lidar::SweepPoint> points;
  lidar::Sweep facts;  ///< its `points` is empty

  /// View for the runtime; valid while this object lives and `points` is not resized.
  lidar::Sweep view() const;
};

struct LoadRequest {
  std::filesystem::path file;         ///< pcap, pcd or ply: the bytes tell which
  std::string model;                  ///< name of a LiDAR; may be empty for pcd and ply
  std::filesystem::path calibration;  ///< empty: the manual's angles, or those in the packets
  bool dual_returns = false;          ///< RoboSense without DIFOP packets: the unit was set to dual return
  lidar::SweepOptions options = {.capacity = 1'000'000};
  std::size_t max_sweeps = SIZE_MAX;  ///< stop after as many; a shot needs few of a long recording
};

/// What stood in the file besides sweeps.
struct LoadReport {
  PcapCounters pcap;
  lidar::SweepCounters counters;
  std::map<std::string, uint64_t> other_packets;  ///< by kind: position, difop, imu, other
  std::map<std::string, uint64_t> refused;        ///< point packets that could not be used, by reason
  std::map<std::string, uint64_t> look_like;      ///< models that packets name themselves
  uint8_t return_mode = 0, product_byte = 0;
  uint16_t motor_rpm = 0;
  uint8_t returns = 1;
  uint64_t realigned = 0;  ///< packets put together again from a recording cut at the wrong places
  std::vector<std::string> warnings;
};

struct Recording {
  bool packets = false;  ///< false: a point cloud file
  lidar::Calibration calibration;
  std::vector<LoadedSweep> sweeps;
  LoadReport report;
};

/// Reads a recording into sweeps. Sweeps with flags are delivered too: the caller decides.
/// @throws ToolError for files that cannot be read, unknown models, missing calibration, and recordings without a
/// single
///         point packet of the model; the message says what the packets look like instead.
Recording load_sweeps(const LoadRequest& request);

/// The same from bytes in memory. `name` is for messages.
Recording load_sweeps(const std::string& name, lidar::Bytes bytes, const LoadRequest& request);

/// "lost packets", "partial", ... of a sweep's flags.
std::vector<std::string> flag_names(uint32_t flags);

}  // namespace roomcal::tools
