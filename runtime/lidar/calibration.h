#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "runtime/base/status.h"
#include "runtime/lidar/model.h"
#include "runtime/math/types.h"

namespace roomcal::lidar {

/// Where one laser points and how its range is corrected, as the unit's file tells.
struct Beam {
  double elevation_rad = 0;        ///< above the sensor's horizontal plane
  double azimuth_offset_rad = 0;   ///< added to the packet's azimuth, in the packet's sense
  double range_offset_m = 0;       ///< added to the range
  double vertical_offset_m = 0;    ///< of the laser's origin along the sensor's z
  double horizontal_offset_m = 0;  ///< of the laser's origin, at right angles to the beam (Velodyne's "horiz offset")
};

/// Point layouts of an Ouster's UDP packets; source: Ouster firmware user manual, "Lidar data packet format".
enum class OusterProfile : uint8_t { kLegacy, kSingle19, kDual19, kLow15, kFusaDual15, kFiveWord };

/// What the packets of an Ouster look like and how its beams leave it: from the metadata JSON, read on the host.
struct OusterFormat {
  OusterProfile profile = OusterProfile::kLegacy;
  uint16_t columns_per_frame = 1024;
  uint16_t columns_per_packet = 16;
  uint16_t first_column = 0, last_column = 1023;  ///< the azimuth window; first > last: it passes column 0
  std::array<int16_t, kMaxBeams> pixel_shift{};   ///< columns by which a row is staggered, for images of the sweep
  double beam_origin_m = 0;                       ///< from the axis to where beams start
  double beam_origin_z_m = 0;                     ///< the same, upwards
  Mat44 T_sensor_lidar = Mat44::Identity();       ///< metres
  uint64_t serial = 0;                            ///< 0: unknown
};

/// Everything that turns one sensor's packets into points. Plain memory, about 12 kB, no pointers.
struct Calibration {
  Model model = Model::kVlp16;
  uint16_t beam_count = 0;
  bool from_unit = false;     ///< false: the manual's angles
  bool dual_returns = false;  ///< RoboSense: said by the DIFOP packet, as point packets do not tell
  std::array<Beam, kMaxBeams> beams{};
  OusterFormat ouster;

  /// Sines and cosines of `beams`, by make_calibration().
  struct Trig {
    double cos_elevation = 1, sin_elevation = 0, cos_offset = 1, sin_offset = 0;
  };
  std::array<Trig, kMaxBeams> trig{};
};

/// Checks the beams and prepares their sines.
///
/// @param beams  one for each laser of the model, in the order of its packets.
/// @return kInvalidArgument for another number of beams, for numbers that are not finite or absurd, and for a table
/// whose
///         beams all have one elevation (a flat cloud) unless the model has one beam.
Result<Calibration> make_calibration(Model model, std::span<const Beam> beams);

/// An Ouster's: also checks its format. @return as above.
Result<Calibration> make_calibration(const OusterFormat& format, std::span<const Beam> beams);

/// The manual's angles. @return kNotFound for models whose angles only the unit knows: give its file.
Result<Calibration> built_in_calibration(Model model);

/// Columns that one turn of an Ouster sends, by its azimuth window.
uint32_t window_columns(const OusterFormat& format);

}  // namespace roomcal::lidar
