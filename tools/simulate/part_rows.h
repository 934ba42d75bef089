#pragma once

#include <array>
#include <deque>
#include <vector>

#include "tools/simulate/disc_filter.h"
#include "tools/simulate/raster.h"

namespace roomcal::tools {

/// One row of pixels as rows of samples, sample by sample of a pixel: contiguous for the compiler.
using PartRow = std::array<std::vector<float>, kSub * kSub>;

/// Rows of a picture's samples, in focus or not. Rows must be asked for from above to below, one after the other.
class PartRows {
 public:
  /// @param margin_px  by which a row is wider than the picture, on each side. @param first_y  of the rows
  PartRows(const Radiance& radiance, const DiscFilter& disc, int margin_px, int width, int first_y);

  /// Of pixel row y; valid until the next call.
  const PartRow& at(int y);

 private:
  void sample(int y);
  /// Sums of the next pixel row's rows of samples, wider by the disc's margin.
  void sum_next();
  void defocus(int y);

  const Radiance& radiance_;
  const DiscFilter& disc_;
  int margin_px_;
  std::size_t padded_;
  PartRow row_;
  int next_y_;                            ///< next pixel row to be summed up
  std::deque<std::vector<double>> sums_;  ///< of the latest rows of samples
};

}  // namespace roomcal::tools
