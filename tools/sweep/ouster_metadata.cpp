#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tools/common/error.h"
#include "tools/sweep/calibration_files.h"

namespace roomcal::tools {

using Json = nlohmann::json;
using lidar::Beam;
using lidar::OusterFormat;
using lidar::OusterProfile;

namespace {

struct ProfileName {
  const char* name;
  OusterProfile profile;
};
constexpr std::array kProfiles = {
    ProfileName{"LEGACY", OusterProfile::kLegacy},
    ProfileName{"RNG19_RFL8_SIG16_NIR16", OusterProfile::kSingle19},
    ProfileName{"RNG19_RFL8_SIG16_NIR16_DUAL", OusterProfile::kDual19},
    ProfileName{"RNG15_RFL8_NIR8", OusterProfile::kLow15},
    ProfileName{"FUSA_RNG15_RFL8_NIR8_DUAL", OusterProfile::kFusaDual15},
    ProfileName{"FIVE_WORD_PIXEL", OusterProfile::kFiveWord},
};

class MetadataReader {
 public:
  MetadataReader(const std::string& name, const std::string& text) : name_(name) {
    try {
      root_ = Json::parse(text);
    } catch (const Json::exception& error) {
      fail(fmt::format("not JSON: {}", error.what()));
    }
    if (!root_.is_object()) fail("expected the metadata object of an Ouster");
  }

  [[noreturn]] void fail(const std::string& message) const { throw ToolError(name_ + ": " + message); }

  /// A key of the flat form, or within any of the groups of the nested one. @return nullptr if absent
  const Json* find(const char* key) const {
    if (const auto it = root_.find(key); it != root_.end()) return &*it;
    for (const char* group :
         {"beam_intrinsics", "lidar_intrinsics", "lidar_data_format", "data_format", "sensor_info", "config_params"}) {
      const auto inner = root_.find(group);
      if (inner == root_.end() || !inner->is_object()) continue;
      if (const auto it = inner->find(key); it != inner->end()) return &*it;
    }
    return nullptr;
  }

  double number(const Json& value, const char* key) const {
    if (!value.is_number() || !std::isfinite(value.get<double>())) fail(fmt::format("`{}` must be a number", key));
    return value.get<double>();
  }

  int whole(const Json& value, const char* key, int low, int high) const {
    const double number_value = number(value, key);
    if (number_value < low || number_value > high || number_value != std::floor(number_value))
      fail(fmt::format("`{}` must be a whole number of {} to {}", key, low, high));
    return static_cast<int>(number_value);
  }

  /// Numbers of a list, nested or not, in order. @return empty if the key is absent
  std::vector<double> numbers(const char* key, std::size_t most) const {
    std::vector<double> values;
    const Json* list = find(key);
    if (list == nullptr || list->is_null()) return values;
    if (!list->is_array()) fail(fmt::format("`{}` must be a list", key));
    for (const Json& item : *list) {
      if (item.is_array()) {
        for (const Json& inner : item) values.push_back(number(inner, key));
      } else {
        values.push_back(number(item, key));
      }
      if (values.size() > most) fail(fmt::format("`{}` has more than {} numbers", key, most));
    }
    return values;
  }

  std::string text(const char* key) const {
    const Json* value = find(key);
    return value != nullptr && value->is_string() ? value->get<std::string>() : "";
  }

 private:
  const std::string& name_;
  Json root_;
};

OusterProfile read_profile(const MetadataReader& reader) {
  const std::string name = reader.text("udp_profile_lidar");
  if (name.empty()) return OusterProfile::kLegacy;
  for (const ProfileName& known : kProfiles)
    if (name == known.name) return known.profile;
  std::string list;
  for (const ProfileName& known : kProfiles) list += fmt::format(" {}", known.name);
  reader.fail(fmt::format("profile `{}` is not read; set the sensor to one of:{}", name, list));
}

void read_columns(const MetadataReader& reader, OusterFormat& format) {
  int64_t columns = 1024;
  const std::string mode = reader.text("lidar_mode");
  if (mode.find('x') != std::string::npos) columns = std::strtol(mode.c_str(), nullptr, 10);
  if (const Json* value = reader.find("columns_per_frame"))
    columns = reader.whole(*value, "columns_per_frame", 64, 4096);
  if (columns < 64 || columns > 4096) reader.fail(fmt::format("lidar_mode `{}` is not understood", mode));
  format.columns_per_frame = static_cast<uint16_t>(columns);
  if (const Json* value = reader.find("columns_per_packet"))
    format.columns_per_packet = static_cast<uint16_t>(reader.whole(*value, "columns_per_packet", 1, 16));
  format.first_column = 0;
  format.last_column = static_cast<uint16_t>(columns - 1);
  const std::vector<double> window = reader.numbers("column_window", 2);
  if (window.empty()) return;
  const auto column = [&](double value) {
    if (value < 0 || value >= columns || value != std::floor(value)) reader.fail("`column_window` is not understood");
    return static_cast<uint16_t>(value);
  };
  if (window.size() != 2) reader.fail("`column_window` must have two numbers");
  format.first_column = column(window[0]);
  format.last_column = column(window[1]);
}

/// The 16 numbers of a transform in millimetres. @return empty if absent
std::vector<double> read_transform_mm(const MetadataReader& reader, const char* key) {
  const std::vector<double> values = reader.numbers(key, 16);
  if (!values.empty() && values.size() != 16) reader.fail(fmt::format("`{}` must have 16 numbers", key));
  return values;
}

void read_geometry(const MetadataReader& reader, OusterFormat& format) {
  if (const Json* value = reader.find("lidar_origin_to_beam_origin_mm"))
    format.beam_origin_m = 0.001 * reader.number(*value, "lidar_origin_to_beam_origin_mm");
  if (const std::vector<double> T = read_transform_mm(reader, "beam_to_lidar_transform"); !T.empty()) {
    format.beam_origin_m = 0.001 * T[3];
    format.beam_origin_z_m = 0.001 * T[11];
  }
  // What every unit so far has: turned by half a turn, 36.18 mm above the base.
  format.T_sensor_lidar << -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0.03618, 0, 0, 0, 1;
  if (const std::vector<double> T = read_transform_mm(reader, "lidar_to_sensor_transform"); !T.empty()) {
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column) {
        const double value = T[static_cast<std::size_t>(4 * row + column)];
        format.T_sensor_lidar(row, column) = column == 3 && row < 3 ? 0.001 * value : value;
      }
    const Mat33 R = format.T_sensor_lidar.topLeftCorner<3, 3>();
    if (!(R.cwiseAbs().maxCoeff() < 2) || (R * R.transpose() - Mat33::Identity()).norm() > 1e-3)
      reader.fail("`lidar_to_sensor_transform` is not a rigid transform");
  }
}

}  // namespace

lidar::Calibration parse_ouster_json(const std::string& name, const std::string& text) {
  const MetadataReader reader(name, text);
  const std::vector<double> altitude = reader.numbers("beam_altitude_angles", lidar::kMaxBeams);
  const std::vector<double> azimuth = reader.numbers("beam_azimuth_angles", lidar::kMaxBeams);
  if (altitude.empty() || altitude.size() != azimuth.size())
    reader.fail(
        "`beam_altitude_angles` and `beam_azimuth_angles` must be lists of one length; is this Ouster metadata?");
  if (const Json* rows = reader.find("pixels_per_column"))
    if (reader.whole(*rows, "pixels_per_column", 1, 128) != static_cast<int>(altitude.size()))
      reader.fail("`pixels_per_column` and the number of beam angles disagree");
  OusterFormat format;
  format.profile = read_profile(reader);
  read_columns(reader, format);
  read_geometry(reader, format);
  format.serial = std::strtoull(reader.text("prod_sn").c_str(), nullptr, 10);
  const std::vector<double> shift = reader.numbers("pixel_shift_by_row", lidar::kMaxBeams);
  for (std::size_t i = 0; i < std::min(shift.size(), altitude.size()); ++i)
    format.pixel_shift[i] = static_cast<int16_t>(std::clamp(shift[i], -4096.0, 4096.0));
  std::vector<Beam> beams(altitude.size());
  for (std::size_t i = 0; i < beams.size(); ++i) {
    beams[i].elevation_rad = deg_to_rad(altitude[i]);
    beams[i].azimuth_offset_rad = deg_to_rad(azimuth[i]);
  }
  const Result<lidar::Calibration> made = lidar::make_calibration(format, beams);
  if (!made.ok()) reader.fail(made.status().detail());
  return made.value();
}

}  // namespace roomcal::tools
