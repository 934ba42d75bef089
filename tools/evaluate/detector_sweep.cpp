#include "tools/evaluate/detector_sweep.h"

#include "tools/common/progress.h"

namespace roomcal::tools {

namespace {

constexpr double kStrongGradient = 0.3;

/// What is rendered once and looked at with every noise.
struct Batch {
  std::vector<double> diameters_px;
  std::vector<double> slants_deg;
  std::vector<double> gradients;
  std::vector<double> noises;
  bool fisheye = false;
  int markers_per_cell = 120;
};

std::vector<Batch> full_plan() {
  return {{{15, 20, 30, 40, 60, 100}, {0, 30, 45, 60, 70, 75}, {0, kStrongGradient}, {2, 5}},
          {{200, 400, 900}, {0, 45, 70}, {kStrongGradient}, {2}, false, 6},
          {{20, 40}, {0, 45, 60}, {kStrongGradient}, {2}, true}};
}

std::vector<Batch> quick_plan() {
  return {{{15, 30, 60}, {0, 45, 70}, {0, kStrongGradient}, {2}},
          {{100}, {45}, {kStrongGradient}, {2}},
          {{200}, {45}, {kStrongGradient}, {2}, false, 6},
          {{30}, {45}, {kStrongGradient}, {2}, true}};
}

/// In the order of the table: diameter, slant, gradient.
std::vector<CellSpec> specs_of(const Batch& batch) {
  std::vector<CellSpec> specs;
  for (const double diameter : batch.diameters_px) {
    for (const double slant : batch.slants_deg) {
      for (const double gradient : batch.gradients) specs.push_back({diameter, slant, gradient, 0, batch.fisheye});
    }
  }
  return specs;
}

}  // namespace

DetectorSweep run_detector_sweep(bool quick) {
  const std::vector<Batch> plan = quick ? quick_plan() : full_plan();
  std::size_t total = 0;
  for (const Batch& batch : plan) total += specs_of(batch).size();
  Progress progress("detector sweep", total);
  DetectorSweep sweep;
  std::vector<std::byte> scratch;
  sweep.empty_ms_per_mp = empty_image_ms_per_mp(scratch);
  for (const Batch& batch : plan) {
    for (const CellSpec& spec : specs_of(batch)) {
      for (const CellResult& cell : run_cells(spec, batch.noises, batch.markers_per_cell, scratch)) {
        sweep.cells.push_back(cell);
      }
      progress.step();
    }
  }
  return sweep;
}

}  // namespace roomcal::tools
