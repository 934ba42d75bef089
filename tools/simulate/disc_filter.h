#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace roomcal::tools {

/// The image of a point out of focus: an even disc. Acts on rows of samples (kSub of them a pixel, both ways).
class DiscFilter {
 public:
  /// @param diameter_px  of the disc; 0: a point stays a point
  explicit DiscFilter(double diameter_px);

  bool active() const { return !half_chords_.empty(); }
  /// Pixels around a sample that it may draw from.
  int margin_px() const { return margin_px_; }
  /// Rows of samples above and below that it draws from.
  int reach() const { return static_cast<int>(half_chords_.size() / 2); }

  /// Running sums of a row: sums[i] is that of the first i samples. @param sums  one longer than the row
  static void sum_up(std::span<const float> row, std::span<double> sums);

  /// @param rows  sums of 2 reach() + 1 rows, from above to below
  /// @param at    a sample of the middle row, off the row's ends by the margin at least
  float average(std::span<const double* const> rows, std::size_t at) const;

 private:
  std::vector<double> half_chords_;  ///< of the disc, in samples, row by row
  double area_ = 0;                  ///< of all chords
  int margin_px_ = 0;
};

}  // namespace roomcal::tools
