#include "tools/sweep/calibration_files.h"

#include <sstream>
#include <vector>

#include <fmt/core.h>

#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/common/yaml.h"

namespace roomcal::tools {

using lidar::Beam;
using lidar::Calibration;
using lidar::Model;

namespace {

Calibration checked(const Result<Calibration>& made, const std::string& name) {
  if (!made.ok()) throw ToolError(name + ": " + made.status().detail());
  return made.value();
}

/// Rows of numbers; lines before the first that begins with a number are head. Blank lines and CR are nothing.
std::vector<std::vector<double>> number_rows(const std::string& name, const std::string& text, std::size_t columns) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) line.pop_back();
    if (line.empty()) continue;
    std::vector<double> row;
    std::istringstream cells(line);
    std::string cell;
    bool good = true;
    while (std::getline(cells, cell, ',')) {
      while (!cell.empty() && (cell.front() == ' ' || cell.front() == '+')) cell.erase(0, 1);
      while (!cell.empty() && (cell.back() == ' ' || cell.back() == '\t')) cell.pop_back();
      double value = 0;
      good = good && parse_finite(cell, value);
      row.push_back(value);
    }
    if (!good && rows.empty()) continue;
    if (!good || row.size() < columns)
      throw ToolError(fmt::format("{}:{}: expected {} numbers with commas between", name, number, columns));
    rows.push_back(std::move(row));
    if (rows.size() > lidar::kMaxBeams) throw ToolError(name + ": more than 128 lasers; is this an angle table?");
  }
  return rows;
}

void check_count(const std::string& name, Model model, std::size_t count) {
  if (count == lidar::info(model).beams) return;
  throw ToolError(fmt::format("{}: {} lasers, a {} has {}; give this unit's file", name, count,
                              lidar::info(model).product, lidar::info(model).beams));
}

double optional_number(const YamlText& yaml, const YAML::Node& laser, const char* key) {
  const YAML::Node value = laser[key];
  return value ? yaml.number(value, key) : 0;
}

}  // namespace

Calibration parse_hesai_csv(Model model, const std::string& name, const std::string& text) {
  const auto rows = number_rows(name, text, 3);
  check_count(name, model, rows.size());
  std::vector<Beam> beams(rows.size());
  std::vector<bool> seen(rows.size(), false);
  for (const std::vector<double>& row : rows) {
    const double channel = row[0];
    const bool whole = channel >= 1 && channel <= static_cast<double>(rows.size()) &&
                       channel == static_cast<double>(static_cast<std::size_t>(channel));
    const std::size_t i = whole ? static_cast<std::size_t>(channel) - 1 : 0;
    if (!whole || seen[i])
      throw ToolError(fmt::format("{}: channel {} is out of range or stands twice", name, channel));
    seen[i] = true;
    beams[i].elevation_rad = deg_to_rad(row[1]);
    beams[i].azimuth_offset_rad = deg_to_rad(row[2]);
  }
  return checked(lidar::make_calibration(model, beams), name);
}

Calibration parse_robosense_csv(const std::string& name, const std::string& text) {
  const auto rows = number_rows(name, text, 2);
  check_count(name, Model::kHelios16p, rows.size());
  std::vector<Beam> beams(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    beams[i].elevation_rad = deg_to_rad(rows[i][0]);
    beams[i].azimuth_offset_rad = deg_to_rad(rows[i][1]);
  }
  return checked(lidar::make_calibration(Model::kHelios16p, beams), name);
}

Calibration parse_velodyne_yaml(Model model, const std::string& name, const std::string& text) {
  const YamlText yaml(name, text);
  const YAML::Node lasers = yaml.field(yaml.root(), "lasers");
  if (!lasers.IsSequence()) yaml.fail(lasers, "`lasers` must be a list");
  check_count(name, model, lasers.size());
  std::vector<Beam> beams(lasers.size());
  std::vector<bool> seen(lasers.size(), false);
  for (const YAML::Node& laser : lasers) {
    const int id = yaml.whole_number(yaml.field(laser, "laser_id"), "laser_id");
    if (id < 0 || static_cast<std::size_t>(id) >= beams.size() || seen[static_cast<std::size_t>(id)])
      yaml.fail(laser, "laser_id is out of range or stands twice");
    if (laser["two_pt_correction_available"] && laser["two_pt_correction_available"].as<std::string>("") == "true")
      yaml.fail(laser, "two-point range corrections are of the HDL-64E, which is not read");
    seen[static_cast<std::size_t>(id)] = true;
    Beam& beam = beams[static_cast<std::size_t>(id)];
    beam.elevation_rad = yaml.number(yaml.field(laser, "vert_correction"), "vert_correction");
    beam.azimuth_offset_rad = -yaml.number(yaml.field(laser, "rot_correction"), "rot_correction");
    beam.range_offset_m = optional_number(yaml, laser, "dist_correction");
    beam.vertical_offset_m = optional_number(yaml, laser, "vert_offset_correction");
    beam.horizontal_offset_m = optional_number(yaml, laser, "horiz_offset_correction");
  }
  return checked(lidar::make_calibration(model, beams), name);
}

Calibration read_calibration(Model model, const std::filesystem::path& path) {
  const lidar::ModelInfo& model_info = lidar::info(model);
  if (path.empty()) {
    if (model_info.angles == lidar::AngleSource::kUnitRequired) {
      throw ToolError(fmt::format("{}: its angles are the unit's own; give its {} with --calibration",
                                  model_info.product, model == Model::kOuster ? "metadata JSON" : "angle file (CSV)"));
    }
    return checked(lidar::built_in_calibration(model), model_info.product);
  }
  const std::string name = path.string(), text = read_text(path);
  switch (model_info.family) {
    case lidar::Family::kVelodyne:
      return parse_velodyne_yaml(model, name, text);
    case lidar::Family::kHesai:
      return parse_hesai_csv(model, name, text);
    case lidar::Family::kOuster:
      return parse_ouster_json(name, text);
    case lidar::Family::kRobosense:
      return parse_robosense_csv(name, text);
    default:
      throw ToolError(fmt::format("{}: a {} carries its angles in its packets; leave --calibration away", name,
                                  model_info.product));
  }
}

}  // namespace roomcal::tools
