#include "runtime/lidar/calibration.h"

#include <algorithm>
#include <cmath>

namespace roomcal::lidar {

namespace {

constexpr double kMaxOffset_m = 1;  // of a laser's origin or range: sensors are smaller

// Velodyne VLP-16 manual 63-9243, table "vertical angle by laser id". Its vertical corrections (up to 11 mm) are in the
// unit's file where somebody wants them: neither the vendor's viewer data nor the reference clouds apply them.
constexpr std::array<double, 16> kVlp16ElevationDeg = {-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15};

// Velodyne VLP-32C manual 63-9325, table of elevations and azimuth offsets by laser id.
constexpr std::array<double, 32> kVlp32cElevationDeg = {-25,    -1,    -1.667, -15.639, -11.31, 0,     -0.667, -8.843,
                                                        -7.254, 0.333, -0.333, -6.148,  -5.333, 1.333, 0.667,  -4,
                                                        -4.667, 1.667, 1,      -3.667,  -3.333, 3.333, 2.333,  -2.667,
                                                        -3,     7,     4.667,  -2.333,  -2,     15,    10.333, -1.333};
constexpr std::array<double, 32> kVlp32cAzimuthDeg = {1.4,  -4.2, 1.4,  -1.4, 1.4,  -1.4, 4.2,  -1.4, 1.4,  -4.2, 1.4,
                                                      -1.4, 4.2,  -1.4, 4.2,  -1.4, 1.4,  -4.2, 1.4,  -4.2, 4.2,  -1.4,
                                                      1.4,  -1.4, 1.4,  -1.4, 1.4,  -4.2, 4.2,  -1.4, 1.4,  -1.4};

// RoboSense Helios-16P user guide, "channel angles"; the unit's own come in its DIFOP packets or a file.
constexpr std::array<double, 16> kHelios16pElevationDeg = {14.94, 13.03, 10.92, 8.90,  6.96,  5.46,  3.98,  2.67,
                                                           1.33,  0,     -1.33, -2.67, -3.96, -5.23, -6.63, -8.01};
constexpr std::array<double, 16> kHelios16pAzimuthDeg = {-4.05, 3.61, -4.00, 3.58, -3.97, 3.56, -3.96, 3.55,
                                                         -3.95, 3.55, -3.95, 3.55, -3.96, 3.56, -3.97, 3.57};

bool sane(const Beam& beam) {
  for (const double value : {beam.elevation_rad, beam.azimuth_offset_rad, beam.range_offset_m, beam.vertical_offset_m,
                             beam.horizontal_offset_m})
    if (!std::isfinite(value)) return false;
  return std::abs(beam.elevation_rad) <= kPi / 2 && std::abs(beam.azimuth_offset_rad) <= kPi &&
         std::abs(beam.range_offset_m) <= kMaxOffset_m && std::abs(beam.vertical_offset_m) <= kMaxOffset_m &&
         std::abs(beam.horizontal_offset_m) <= kMaxOffset_m;
}

bool flat(std::span<const Beam> beams) {
  return beams.size() > 1 && std::all_of(beams.begin(), beams.end(), [&](const Beam& beam) {
           return beam.elevation_rad == beams[0].elevation_rad;
         });
}

Result<Calibration> with_beams(Model model, std::span<const Beam> beams) {
  if (beams.size() > kMaxBeams || beams.empty())
    return Status{StatusCode::kInvalidArgument, "a beam table holds 1 to 128 beams"};
  if (!std::all_of(beams.begin(), beams.end(), sane))
    return Status{StatusCode::kInvalidArgument,
                  "a beam angle or offset is not finite or absurd: check the unit's file"};
  if (flat(beams))
    return Status{StatusCode::kInvalidArgument, "all beams have one elevation: this is not a table of a 3-D LiDAR"};
  Calibration calibration;
  calibration.model = model;
  calibration.beam_count = static_cast<uint16_t>(beams.size());
  for (std::size_t i = 0; i < beams.size(); ++i) {
    calibration.beams[i] = beams[i];
    calibration.trig[i] = {std::cos(beams[i].elevation_rad), std::sin(beams[i].elevation_rad),
                           std::cos(beams[i].azimuth_offset_rad), std::sin(beams[i].azimuth_offset_rad)};
  }
  return calibration;
}

bool sane(const OusterFormat& format, std::size_t rows) {
  const uint16_t columns = format.columns_per_frame;
  const bool window = format.first_column < columns && format.last_column < columns;
  return columns >= 64 && columns <= 4096 && format.columns_per_packet >= 1 && format.columns_per_packet <= 16 &&
         columns % format.columns_per_packet == 0 && window && rows % 16 == 0 &&
         std::abs(format.beam_origin_m) <= kMaxOffset_m && std::abs(format.beam_origin_z_m) <= kMaxOffset_m &&
         format.T_sensor_lidar.allFinite() && format.T_sensor_lidar.topRightCorner<3, 1>().cwiseAbs().maxCoeff() <= 10;
}

template <std::size_t kCount, typename Elevation, typename Azimuth>
Result<Calibration> table(Model model, const Elevation& elevation_deg, const Azimuth& azimuth_deg) {
  std::array<Beam, kCount> beams;
  for (std::size_t i = 0; i < kCount; ++i) {
    beams[i].elevation_rad = deg_to_rad(elevation_deg(i));
    beams[i].azimuth_offset_rad = deg_to_rad(azimuth_deg(i));
  }
  return with_beams(model, beams);
}

double zero(std::size_t) { return 0; }

/// HDL-32E manual 63-9113: two interleaved rows of 4/3 degree, from -30.67 and from -9.33.
double hdl32e_elevation_deg(std::size_t i) {
  return (i % 2 == 0 ? -92.0 : -28.0) / 3 + 4.0 / 3 * static_cast<double>(i / 2);
}

}  // namespace

Result<Calibration> make_calibration(Model model, std::span<const Beam> beams) {
  if (model == Model::kOuster || beams.size() != info(model).beams)
    return Status{StatusCode::kInvalidArgument, "the beam table has another number of beams than this model"};
  Result<Calibration> calibration = with_beams(model, beams);
  if (calibration.ok()) calibration.value().from_unit = true;
  return calibration;
}

Result<Calibration> make_calibration(const OusterFormat& format, std::span<const Beam> beams) {
  if (!sane(format, beams.size()))
    return Status{StatusCode::kInvalidArgument, "Ouster metadata: columns, window, origins or beam count are absurd"};
  Result<Calibration> calibration = with_beams(Model::kOuster, beams);
  if (!calibration.ok()) return calibration;
  calibration.value().ouster = format;
  calibration.value().from_unit = true;
  return calibration;
}

Result<Calibration> built_in_calibration(Model model) {
  const auto in = [](const auto& values) { return [&values](std::size_t i) { return values[i]; }; };
  switch (model) {
    case Model::kVlp16:
      return table<16>(model, in(kVlp16ElevationDeg), zero);
    case Model::kVlp32c:
      return table<32>(model, in(kVlp32cElevationDeg), in(kVlp32cAzimuthDeg));
    case Model::kHdl32e:
      return table<32>(model, hdl32e_elevation_deg, zero);
    case Model::kHelios16p:
      return table<16>(model, in(kHelios16pElevationDeg), in(kHelios16pAzimuthDeg));
    case Model::kR2000:
      return table<1>(model, zero, zero);
    case Model::kMid360:
      // Packets carry coordinates; the numbers only keep the four lines apart.
      return table<4>(
          model, [](std::size_t i) { return static_cast<double>(i); }, zero);
    default:
      return Status{StatusCode::kNotFound, "this model's angles are the unit's own: give its angle file"};
  }
}

uint32_t window_columns(const OusterFormat& format) {
  const uint32_t first = format.first_column, last = format.last_column, all = format.columns_per_frame;
  return first <= last ? last - first + 1 : all - first + last + 1;
}

}  // namespace roomcal::lidar
