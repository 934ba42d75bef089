#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/math/se3.h"
#include "tools/map/map_data.h"

namespace roomcal::tools {

struct CompareOptions {
  double gate_m = 0.05;   ///< markers farther apart after alignment are not the same one
  double slack_m = 0.01;  ///< per axis: how far maps of one room may differ while they are being aligned
};

/// A plane of each map that hold the same wall.
struct PlaneDifference {
  std::size_t plane_a = 0, plane_b = 0;
  double angle_rad = 0;
  double offset_m = 0;  ///< of b's markers on it from a's plane, mean, along a's normal
};

/// How map b lies over map a, identities not used.
struct MapComparison {
  SE3 T_a_b;                                                 ///< rigid: scale errors count
  std::vector<std::pair<std::size_t, std::size_t>> matched;  ///< marker numbers in a and b
  std::vector<double> distance_m;                            ///< of each matched pair
  double mean_m = 0, rms_m = 0, max_m = 0;
  double scale_a_b = 1;          ///< b times this is as large as a
  double rms_after_scale_m = 0;  ///< what would be left if b were scaled by it
  std::vector<PlaneDifference> planes;
};

/// Aligns two maps by triangles (tools/align), then by least squares over all markers within the gate, in turn until
/// the pairs stay.
/// @return nothing if the maps have no place in common that is better than all others.
/// Cost: a second for 340 markers each.
std::optional<MapComparison> compare_maps(const MapData& a, const MapData& b, const CompareOptions& options = {});

}  // namespace roomcal::tools
