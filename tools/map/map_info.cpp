#include "tools/map/map_info.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "tools/map/map_builder.h"

namespace roomcal::tools {

namespace {

using Json = nlohmann::ordered_json;
using Markers = std::vector<map::MapMarker>;

Json to_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json spacing_of(const Markers& markers) {
  std::vector<double> nearest_m;
  for (const map::MapMarker& a : markers) {
    double best_m2 = INFINITY;
    for (const map::MapMarker& b : markers) {
      if (&a != &b) best_m2 = std::min(best_m2, (a.p_room - b.p_room).squaredNorm());
    }
    nearest_m.push_back(std::sqrt(best_m2));
  }
  if (nearest_m.size() < 2) return nullptr;
  std::sort(nearest_m.begin(), nearest_m.end());
  return {{"min", nearest_m.front()}, {"median", nearest_m[nearest_m.size() / 2]}, {"max", nearest_m.back()}};
}

Json range_of(const std::vector<double>& values) {
  if (values.empty()) return nullptr;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return {{"min", *low}, {"max", *high}};
}

Json extent_of(const Markers& markers) {
  Vec3 low = markers.front().p_room, high = low;
  for (const map::MapMarker& marker : markers) {
    low = low.cwiseMin(marker.p_room);
    high = high.cwiseMax(marker.p_room);
  }
  return {{"min", to_json(low)}, {"max", to_json(high)}};
}

Json planes_of(const MapData& data) {
  Json planes = Json::array();
  for (std::size_t i = 0; i < data.planes.size(); ++i) {
    const map::MapPlane& plane = data.planes[i].plane;
    const auto on_it = std::count_if(data.markers.begin(), data.markers.end(),
                                     [&](const map::MapMarker& marker) { return marker.plane == static_cast<int>(i); });
    planes.push_back(
        {{"normal", to_json(plane.normal_room)}, {"d_m", plane.d_m}, {"rms_m", plane.rms_m}, {"markers", on_it}});
  }
  return planes;
}

std::string range_text(const Json& range, double scale, const char* unit, const char* if_none) {
  if (range.is_null()) return if_none;
  const double low = range["min"].get<double>() * scale, high = range["max"].get<double>() * scale;
  return low == high ? fmt::format("{:.4g} {}", low, unit) : fmt::format("{:.4g} to {:.4g} {}", low, high, unit);
}

std::string plane_lines(const Json& planes) {
  std::string lines;
  for (const Json& plane : planes) {
    const auto n = plane["normal"].get<std::vector<double>>();
    lines +=
        fmt::format("    normal {:+.3f} {:+.3f} {:+.3f}, d {:+.3f} m: {} markers, RMS {:.1f} mm\n", n[0], n[1], n[2],
                    plane["d_m"].get<double>(), plane["markers"].get<int>(), plane["rms_m"].get<double>() * 1e3);
  }
  return lines;
}

}  // namespace

double largest_sigma_m(const Mat33& cov_m2) {
  const Eigen::SelfAdjointEigenSolver<Mat33> solver(cov_m2, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[2]));
}

Json describe_map(const map::RoomMap& map, std::size_t bytes, const MapQuality& quality) {
  const MapData data = to_map_data(map);
  std::vector<double> radii_m, sigmas_m;
  int with_normal = 0, estimated = 0;
  for (const map::MapMarker& marker : data.markers) {
    if (marker.has_radius) radii_m.push_back(marker.radius_m);
    sigmas_m.push_back(largest_sigma_m(marker.cov_m2));
    with_normal += marker.has_normal ? 1 : 0;
    estimated += marker.normal_estimated ? 1 : 0;
  }
  return {{"id", data.id},
          {"content_crc32c", fmt::format("{:08x}", map.content_crc32c())},
          {"provenance", data.provenance},
          {"created_unix_s", data.created_unix_s},
          {"bytes", bytes},
          {"markers", data.markers.size()},
          {"with_normal", with_normal},
          {"with_estimated_normal", estimated},
          {"with_radius", radii_m.size()},
          {"extent_m", extent_of(data.markers)},
          {"spacing_m", spacing_of(data.markers)},
          {"radius_m", range_of(radii_m)},
          {"sigma_m", range_of(sigmas_m)},
          {"triangles", data.triangles.size()},
          {"planes", planes_of(data)},
          {"lines", data.lines.size()},
          {"corners", data.corners.size()},
          {"surface_spacing_m", data.surface_spacing_m},
          {"uniqueness", map_quality_json(quality)["uniqueness"]},
          {"quality", map_quality_json(quality)}};
}

std::string summarize_map(const Json& d, const MapQuality& quality) {
  const auto low = d["extent_m"]["min"].get<std::vector<double>>(),
             high = d["extent_m"]["max"].get<std::vector<double>>();
  const bool exact = d["sigma_m"]["max"].get<double>() == 0;
  std::string text = fmt::format("map {}  content {}  {} bytes\n", d["id"].get<std::string>(),
                                 d["content_crc32c"].get<std::string>(), d["bytes"].get<std::size_t>());
  text += fmt::format("  provenance     {}\n", d["provenance"].get<std::string>());
  text += fmt::format("  markers        {}: {} with normal ({} of them estimated), {} with radius\n",
                      d["markers"].get<int>(), d["with_normal"].get<int>(), d["with_estimated_normal"].get<int>(),
                      d["with_radius"].get<int>());
  text += fmt::format("  extent         {:.3f} x {:.3f} x {:.3f} m\n", high[0] - low[0], high[1] - low[1],
                      high[2] - low[2]);
  if (!d["spacing_m"].is_null()) {
    text += fmt::format("  nearest        {}, median {:.1f} mm\n", range_text(d["spacing_m"], 1e3, "mm", ""),
                        d["spacing_m"]["median"].get<double>() * 1e3);
  }
  text += fmt::format("  radius         {}\n", range_text(d["radius_m"], 1e3, "mm", "not known"));
  text +=
      fmt::format("  sigma          {}\n", exact ? "0: claims to be exact" : range_text(d["sigma_m"], 1e3, "mm", ""));
  text += fmt::format("  triangles      {}\n", d["triangles"].get<int>());
  text += fmt::format("  planes         {}\n{}", d["planes"].size(), plane_lines(d["planes"]));
  text += fmt::format("  edges          {}, corners {}\n", d["lines"].get<int>(), d["corners"].get<int>());
  return text + map_quality_text(quality);
}

}  // namespace roomcal::tools
