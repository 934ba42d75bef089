#pragma once

#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/fixed_vector.h"
#include "runtime/base/status.h"
#include "runtime/lidar/sweep.h"
#include "runtime/scan/locate.h"
#include "runtime/scan/sensor_model.h"
#include "runtime/scan/surface.h"

namespace roomcal::scan {

/// What an error of one face's plane does to a LiDAR's estimate: delta (map/plane_error.h) adds pull * delta to the
/// gradient of Location::information, and so moves the pose by information^-1 pull delta.
struct FacePull {
  uint32_t face = 0;
  Eigen::Matrix<double, 6, 3> pull = Eigen::Matrix<double, 6, 3>::Zero();
};
using FacePulls = FixedVector<FacePull, kMaxFaces>;

/// Scratch that find_face_pulls() needs, bytes.
std::size_t face_pull_scratch_bytes();

/// The pulls of all faces that a located LiDAR's points lie on.
///
/// With J the derivatives of a predicted range by the pose and P those by delta, pull = sum w J P', beam offsets
/// eliminated as in Location::information. Some 4000 points stand for all.
/// @param sweeps  those that the location is from.
/// @param[out] pulls  by ascending face; overwritten.
/// @return kOk, kOutOfMemory. Cost: 0.1 to 0.3 ms in a room of ten faces.
Status find_face_pulls(const Surface& surface, std::span<const lidar::Sweep> sweeps, const SensorModel& sensor,
                       const Location& location, Arena& scratch, FacePulls& pulls);

}  // namespace roomcal::scan
