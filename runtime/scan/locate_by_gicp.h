#pragma once

#include "runtime/scan/gicp.h"
#include "runtime/scan/locate.h"

namespace roomcal::scan {

/// Scratch that locate_by_gicp() needs, bytes.
std::size_t locate_by_gicp_scratch_bytes();

/// The paper's way [P, III-C]: a coarse pose from corners, then Generalized ICP on the densified map. Kept as reference
/// for locate(), which is three to six times as exact, and fourteen times where beams have offsets of 10 mm.
///
///     sample -> planes -> coarse poses -> place, twins -> register_by_gicp() from the coarse pose -> accept
///
/// Filled as by locate(), but: no beam offsets, reflectivity is not used, the prior picks the place and takes no
/// further part. Weak directions and `information` are those of the rays on the surface at the pose; `cov` is GICP's
/// scatter plus the inverse of that information, so that what is not seen is not certain either. For rooms that are not
/// planar: register_by_gicp() from a prior pose, on GicpTarget::from_cloud().
/// @return as locate(). Deterministic, no heap. Cost: 30 ms, 70 ms where it does not settle, for 28,800 points, of
/// which 8,192 take part.
Status locate_by_gicp(const Surface& surface, const GicpTarget& target, std::span<const lidar::Sweep> sweeps,
                      const SensorModel& sensor, const PosePrior* prior, const LocateOptions& options,
                      const GicpOptions& gicp, Arena& scratch, Location& location);

}  // namespace roomcal::scan
