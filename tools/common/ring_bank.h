#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace roomcal::tools {

/// Radii of a three-ring marker's circles in fractions of the outer one: ink inside [0], paper inside [1], and so on.
using RingRadii = std::array<double, 6>;

/// Radii of the five inner circles in percent of the outer one, by CCTag-3 identity.
/// Source: alicevision/CCTag, markersToPrint/generators/cctag3.txt.
inline constexpr std::array<std::array<uint8_t, 5>, 32> kCctag3Percent{{
    {90, 80, 70, 60, 50}, {90, 80, 70, 60, 45}, {90, 80, 70, 55, 45}, {90, 80, 70, 55, 40},  //
    {90, 80, 65, 55, 45}, {90, 80, 65, 55, 40}, {90, 80, 65, 50, 40}, {90, 80, 65, 50, 35},  //
    {90, 75, 65, 55, 45}, {90, 75, 65, 55, 40}, {90, 75, 65, 50, 40}, {90, 75, 65, 50, 35},  //
    {90, 75, 60, 50, 40}, {90, 75, 60, 50, 35}, {90, 75, 60, 45, 35}, {90, 75, 60, 45, 30},  //
    {85, 75, 65, 55, 45}, {85, 75, 65, 55, 40}, {85, 75, 65, 50, 40}, {85, 75, 65, 50, 35},  //
    {85, 75, 60, 50, 40}, {85, 75, 60, 50, 35}, {85, 75, 60, 45, 35}, {85, 75, 60, 45, 30},  //
    {85, 70, 60, 50, 40}, {85, 70, 60, 50, 35}, {85, 70, 60, 45, 35}, {85, 70, 60, 45, 30},  //
    {85, 70, 55, 45, 35}, {85, 70, 55, 45, 30}, {85, 70, 55, 40, 30}, {85, 70, 55, 40, 25},
}};

/// @param id  below kCctag3Percent.size().
constexpr RingRadii cctag3_radii(std::size_t id) {
  RingRadii radii{1};
  for (std::size_t i = 0; i < 5; ++i) radii[i + 1] = kCctag3Percent[id][i] / 100.0;
  return radii;
}

/// The identity whose rings our detector sees best. `roomcal evaluate rings`: of small and of steeply slanted markers
/// it finds 94 %, the next one 91 %, identity 0 7 %; and of the 32 it has the smallest error of the centre.
inline constexpr std::size_t kBestRingsId = 31;
inline constexpr RingRadii kBestRings = cctag3_radii(kBestRingsId);

}  // namespace roomcal::tools
