#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "runtime/calib/session.h"
#include "tools/device/device.h"
#include "tools/sweep/load_sweeps.h"

namespace roomcal::tools {

/// What was grabbed of one shot, in the order of the device's sensors. A sensor whose file is missing or damaged has
/// nothing and a line in `troubles`: the others are still worth a look, the verdict tells.
struct ShotFolder {
  std::vector<cv::Mat> images;
  std::vector<std::vector<LoadedSweep>> sweeps;  ///< per LiDAR
  std::vector<std::string> sweep_files;          ///< per LiDAR, name in the folder; empty if it is missing
  std::vector<std::string> troubles;
};

inline constexpr std::size_t kAllSweeps = 0;

/// Reads `<camera>.png|jpg|jpeg|pgm` of every camera and `<lidar>.pcap|pcd|ply` (or the file that device.yaml names) of
/// every LiDAR. A unit's own angles are taken from `<lidar>.csv|json|yaml` beside it.
/// @param sweeps  how many of each LiDAR, whole ones first; kAllSweeps: all.
/// @throws ToolError if the folder does not exist or holds no image of any camera of the device.
ShotFolder read_shot(const std::filesystem::path& folder, const Device& device, std::size_t sweeps);

/// The runtime's view of a shot; valid while the folder lives.
class ShotView {
 public:
  explicit ShotView(const ShotFolder& folder);
  calib::Shot shot() const { return {images_, sweeps_}; }

 private:
  std::vector<ImageView> images_;
  std::vector<std::vector<lidar::Sweep>> views_;
  std::vector<calib::Sweeps> sweeps_;
};

}  // namespace roomcal::tools
