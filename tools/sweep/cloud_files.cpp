#include "tools/sweep/cloud_files.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include <fmt/core.h>

#include "runtime/math/types.h"
#include "tools/common/error.h"

namespace roomcal::tools {

using lidar::Bytes;

namespace {

std::string_view text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), std::min<std::size_t>(bytes.size(), 256)};
}

bool is_ply(Bytes bytes) { return text_of(bytes).starts_with("ply\n") || text_of(bytes).starts_with("ply\r\n"); }

bool is_pcd(Bytes bytes) {
  const std::string_view text = text_of(bytes);
  return text.starts_with("# .PCD") || text.starts_with("VERSION") || text.starts_with("FIELDS");
}

const std::vector<double>* find_any(const CloudTable& table, std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (const std::vector<double>* values = table.find(name)) return values;
  return nullptr;
}

/// Whole number in [low, high]; 0 if the column is absent.
double bounded(const std::vector<double>* values, std::size_t i, double low, double high) {
  if (values == nullptr || !std::isfinite((*values)[i])) return 0;
  return std::clamp((*values)[i], low, high);
}

}  // namespace

const std::vector<double>* CloudTable::find(const std::string& name) const {
  for (std::size_t i = 0; i < fields.size(); ++i)
    if (fields[i].name == name) return &values[i];
  return nullptr;
}

bool is_cloud(Bytes bytes) { return is_ply(bytes) || is_pcd(bytes); }

LoadedSweep read_cloud(const std::string& name, Bytes bytes) {
  const CloudTable table = is_ply(bytes) ? parse_ply(name, bytes) : parse_pcd(name, bytes);
  const std::vector<double>*x = table.find("x"), *y = table.find("y"), *z = table.find("z");
  if (x == nullptr || y == nullptr || z == nullptr) throw ToolError(name + ": has no fields x, y, z");
  const auto* beam = find_any(table, {"beam", "ring", "channel"});
  const auto* reflectivity = find_any(table, {"reflectivity", "intensity"});
  const auto* offset_ns = find_any(table, {"offset_ns", "t"});
  const auto* return_index = find_any(table, {"return_index"});
  LoadedSweep sweep;
  for (std::size_t i = 0; i < table.points; ++i) {
    const double range = std::sqrt((*x)[i] * (*x)[i] + (*y)[i] * (*y)[i] + (*z)[i] * (*z)[i]);
    if (!std::isfinite(range) || range == 0 || range > 1e4) continue;
    lidar::SweepPoint point;
    point.x_m = static_cast<float>((*x)[i]);
    point.y_m = static_cast<float>((*y)[i]);
    point.z_m = static_cast<float>((*z)[i]);
    point.range_m = static_cast<float>(range);
    const double azimuth = std::atan2((*y)[i], (*x)[i]);
    point.azimuth_rad = static_cast<float>(azimuth < 0 ? azimuth + 2 * kPi : azimuth);
    point.offset_ns = static_cast<int32_t>(bounded(offset_ns, i, 0, 2e9));
    point.beam = static_cast<uint16_t>(bounded(beam, i, 0, 65534));
    point.reflectivity = static_cast<uint16_t>(bounded(reflectivity, i, 0, 65535));
    point.return_index = static_cast<uint8_t>(bounded(return_index, i, 0, 2));
    sweep.facts.beam_count = std::max<uint16_t>(sweep.facts.beam_count, static_cast<uint16_t>(point.beam + 1));
    sweep.facts.duration_ns = std::max<int64_t>(sweep.facts.duration_ns, point.offset_ns);
    sweep.points.push_back(point);
  }
  if (sweep.points.empty()) throw ToolError(name + ": holds no point");
  return sweep;
}

}  // namespace roomcal::tools
