#include "tools/sweep/compare.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/sweep/cloud_files.h"
#include "tools/sweep/ouster_digest.h"

namespace roomcal::tools {

namespace {

constexpr double kCell_m = 0.1;  // farther than this counts as this far

/// Points in cubes of kCell_m, to find the nearest within one cube's width.
class NearestPoint {
 public:
  void add(const Vec3& p) { cells_[key(cell(p.x()), cell(p.y()), cell(p.z()))].push_back(p); }

  double distance_m(const Vec3& p) const {
    double best = kCell_m;
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz) {
          const auto found = cells_.find(key(cell(p.x()) + dx, cell(p.y()) + dy, cell(p.z()) + dz));
          if (found == cells_.end()) continue;
          for (const Vec3& q : found->second) best = std::min(best, (p - q).norm());
        }
    return best;
  }

 private:
  static int64_t cell(double x) { return static_cast<int64_t>(std::floor(x / kCell_m)); }
  static uint64_t key(int64_t x, int64_t y, int64_t z) {
    return (static_cast<uint64_t>(x) & 0x1FFFFF) << 42 | (static_cast<uint64_t>(y) & 0x1FFFFF) << 21 |
           (static_cast<uint64_t>(z) & 0x1FFFFF);
  }

  std::unordered_map<uint64_t, std::vector<Vec3>> cells_;
};

/// nebula and the vendors' ROS drivers give x forward, y left where Velodyne's manual has y forward, x right.
Vec3 turned_to_ros(const Vec3& p) { return {p.y(), -p.x(), p.z()}; }

Comparison compare_clouds(const Recording& recording, const std::string& name, lidar::Bytes bytes) {
  const LoadedSweep reference = read_cloud(name, bytes);
  std::vector<double> found = nearest_distances_m(reference.view(), recording.sweeps, false);
  const std::vector<double> ros = nearest_distances_m(reference.view(), recording.sweeps, true);
  if (ros[ros.size() / 2] < found[found.size() / 2]) found = ros;
  Comparison comparison;
  comparison.points = found.size();
  comparison.median_mm = 1e3 * found[found.size() / 2];
  comparison.p99_mm = 1e3 * found[found.size() * 99 / 100];
  comparison.max_mm = 1e3 * found.back();
  comparison.beyond_1mm =
      static_cast<std::size_t>(std::count_if(found.begin(), found.end(), [](double d) { return d > 1e-3; }));
  return comparison;
}

Comparison compare_digests(const Recording& recording, const LoadRequest& request, const std::string& name,
                           const nlohmann::json& reference) {
  if (recording.calibration.model != lidar::Model::kOuster)
    throw ToolError(name + ": digests are compared for Ouster recordings only; give a point cloud");
  const AlignedBytes pcap = read_bytes(request.file);
  const auto ours = ouster_digests(request.file.string(), pcap.span(), recording.calibration);
  Comparison comparison;
  for (const auto& [field, digest] : reference.items()) {
    const auto found = ours.find(field);
    comparison.fields[field] = found != ours.end() && digest.is_string() && digest.get<std::string>() == found->second;
  }
  return comparison;
}

}  // namespace

std::vector<double> nearest_distances_m(const lidar::Sweep& of, std::span<const LoadedSweep> among, bool ros_axes) {
  NearestPoint points;
  for (const LoadedSweep& sweep : among) {
    const lidar::Sweep view = sweep.view();
    for (std::size_t i = 0; i < view.points.size(); ++i)
      points.add(ros_axes ? turned_to_ros(view.position_lidar(i)) : view.position_lidar(i));
  }
  std::vector<double> result;
  for (std::size_t i = 0; i < of.points.size(); ++i) result.push_back(points.distance_m(of.position_lidar(i)));
  std::sort(result.begin(), result.end());
  return result;
}

Comparison compare(const Recording& recording, const LoadRequest& request, const std::filesystem::path& reference) {
  const AlignedBytes bytes = read_bytes(reference);
  const std::string name = reference.string();
  if (is_cloud(bytes.span())) return compare_clouds(recording, name, bytes.span());
  const std::string text = read_text(reference);
  const nlohmann::json parsed = nlohmann::json::parse(text, nullptr, false);
  if (!parsed.is_object() || !parsed.contains("packet_hash") || !parsed["packet_hash"].is_object())
    throw ToolError(name + ": is neither a point cloud (pcd, ply) nor a JSON with `packet_hash`");
  return compare_digests(recording, request, name, parsed["packet_hash"]);
}

void print_comparison(const Comparison& comparison, const std::string& reference) {
  if (comparison.points > 0) {
    fmt::print("  {}: {} points, nearest decoded: median {:.4f}, p99 {:.4f}, max {:.4f} mm; {} beyond 1 mm\n",
               reference, comparison.points, comparison.median_mm, comparison.p99_mm, comparison.max_mm,
               comparison.beyond_1mm);
  }
  std::size_t equal = 0;
  for (const auto& [field, same] : comparison.fields) {
    equal += same;
    if (!same) fmt::print("  {}: field {} differs\n", reference, field);
  }
  if (!comparison.fields.empty())
    fmt::print("  {}: {} of {} field digests equal\n", reference, equal, comparison.fields.size());
}

nlohmann::json to_json(const Comparison& comparison) {
  nlohmann::json result = {{"fields", comparison.fields}};
  if (comparison.points == 0) return result;
  result["points"] = comparison.points;
  result["median_mm"] = comparison.median_mm;
  result["p99_mm"] = comparison.p99_mm;
  result["max_mm"] = comparison.max_mm;
  result["beyond_1mm"] = comparison.beyond_1mm;
  return result;
}

}  // namespace roomcal::tools
