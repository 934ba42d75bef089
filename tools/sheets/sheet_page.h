#pragma once

#include <string>
#include <vector>

#include "runtime/math/types.h"
#include "tools/common/ring_bank.h"

namespace roomcal::tools {

struct Paper {
  std::string name;
  Vec2 size_mm;
};

/// a4, a3, letter. @throws ToolError that lists them.
const Paper& paper_named(const std::string& name);

/// White that a marker needs around its outer circle, in radii: the detector's light model looks as far as 1.15.
inline constexpr double kQuietRadii = 0.2;
inline constexpr double kBar_mm = 100;

/// Where everything is on a printed sheet: mm from the top left corner, y down.
///
/// The marker sits in the upper square of the page, which may be cut off along the marks; what is for people (number,
/// size bar) stands in the strip below, and the number once more in a corner of the square.
struct SheetPage {
  Paper paper;
  RingRadii ring_radii = kBestRings;
  double radius_mm = 0;
  Vec2 centre_mm = Vec2::Zero();
  double cut_mm = 0;                     ///< height of the cut line
  Vec2 bar_mm = Vec2::Zero();            ///< left end of the size bar
  Vec2 note_mm = Vec2::Zero();           ///< left end of the base line of what is written under the bar
  Vec2 corner_number_mm = Vec2::Zero();  ///< left end of its base line
};

/// @param radius_mm  of the outer circle; 0: the largest whole number that fits.
/// @throws ToolError if the paper is too small for it, naming the largest.
SheetPage layout_sheet(const Paper& paper, double radius_mm, const RingRadii& ring_radii);

}  // namespace roomcal::tools
