#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/time.h"
#include "runtime/math/types.h"

namespace roomcal::lidar {

/// One measured point of a sweep. Frame: the sensor's own, as its manual defines it (see CONVENTIONS.md).
struct SweepPoint {
  float x_m = 0, y_m = 0, z_m = 0;  ///< lidar frame
  float range_m = 0;                ///< as the sensor reports it, along the beam; never 0 for a return
  float azimuth_rad = 0;            ///< of the beam at the time of its firing, in the manual's sense; [0, 2 pi)
  int32_t offset_ns = 0;            ///< time of the firing after Sweep::stamp
  uint16_t beam = 0;                ///< number of the laser, below Sweep::beam_count
  uint16_t reflectivity = 0;        ///< in the sensor's own unit
  uint8_t return_index = 0;  ///< 0: the strongest or only return; 1 (and 2): the others of a dual (triple) return
};

/// What is wrong with a sweep, as bits; a sweep with any of them is reported and not used unless told so.
enum SweepFlag : uint32_t {
  kSweepLostPackets = 1U << 0,  ///< a gap in sequence numbers, azimuths or times
  kSweepPartial = 1U << 1,      ///< begins or ends in the middle of a turn
  kSweepOutOfOrder = 1U << 2,   ///< packets came in a different order than they were sent
  kSweepFull = 1U << 3,         ///< more points than the capacity; the rest was dropped
  kSweepDuplicates = 1U << 4,   ///< packets that came twice were dropped
  kSweepOtherSensor = 1U << 5,  ///< packets name another model or unit than the calibration is of
  kSweepBadPackets = 1U << 6,   ///< packets of this sensor that could not be decoded, or whose checksum is wrong
  kSweepWrongTiming = 1U << 7,  ///< packets do not come at the pace of this model and mode
  kSweepAngleGap = 1U << 8,     ///< points of a turning profiler were dropped: the table's angle was not known
};

/// One turn of a LiDAR: a view, the points belong to whoever cut the sweep.
struct Sweep {
  std::span<const SweepPoint> points;
  Stamp stamp;              ///< of the first firing
  int64_t duration_ns = 0;  ///< from the first firing to the last
  uint16_t beam_count = 0;
  uint32_t flags = 0;         ///< bits of SweepFlag
  uint32_t packets = 0;       ///< that gave points to it
  uint32_t lost_packets = 0;  ///< missing within it, as far as numbers or times tell

  Vec3 position_lidar(std::size_t i) const {
    return Vec3(static_cast<double>(points[i].x_m), static_cast<double>(points[i].y_m),
                static_cast<double>(points[i].z_m));
  }
};

}  // namespace roomcal::lidar
