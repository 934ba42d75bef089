#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/sweep/load_sweeps.h"

namespace roomcal::tools {

/// A recording against what another decoder made of it.
struct Comparison {
  // Against a cloud: distance of every point of the reference to the nearest decoded one.
  std::size_t points = 0;
  double median_mm = 0, p99_mm = 0, max_mm = 0;
  std::size_t beyond_1mm = 0;
  // Against Ouster digests: field -> equal.
  std::map<std::string, bool> fields;
};

/// Distance of every point of `of` to the nearest one of `among`, metres, sorted; 0.1 m and more are all 0.1 m.
/// @param ros_axes  `among` is turned first: x forward, y left instead of Velodyne's and Hesai's x right, y forward.
std::vector<double> nearest_distances_m(const lidar::Sweep& of, std::span<const LoadedSweep> among, bool ros_axes);

/// @param reference  pcd or ply; or the JSON of MD5 digests that come with Ouster's test captures.
/// @throws ToolError as load_sweeps() and for a reference of neither kind.
Comparison compare(const Recording& recording, const LoadRequest& request, const std::filesystem::path& reference);

void print_comparison(const Comparison& comparison, const std::string& reference);
nlohmann::json to_json(const Comparison& comparison);

}  // namespace roomcal::tools
