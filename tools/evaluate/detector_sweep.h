#pragma once

#include <string>
#include <vector>

#include "tools/evaluate/detector_cell.h"

namespace roomcal::tools {

struct DetectorSweep {
  std::vector<CellResult> cells;
  double empty_ms_per_mp = 0;
};

/// Size x slant x light x noise; a few sizes up to 900 px and a fisheye lens beside them.
/// @param quick  every other step of each, for a first look
DetectorSweep run_detector_sweep(bool quick);

/// One demand and what was measured.
struct Bar {
  std::string demand;
  std::string measured;
  bool met = false;
};

/// The demands on the detector; the worst case of each.
std::vector<Bar> judge_sweep(const DetectorSweep& sweep);

}  // namespace roomcal::tools
