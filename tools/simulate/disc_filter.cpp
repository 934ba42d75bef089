#include "tools/simulate/disc_filter.h"

#include <algorithm>
#include <cmath>

#include "tools/simulate/raster.h"

namespace roomcal::tools {

namespace {

/// Integral of a row up to a place between samples; sample i lies from i to i + 1.
double integral(const double* sums, double at) {
  const auto whole = static_cast<std::size_t>(at);
  return std::lerp(sums[whole], sums[whole + 1], at - static_cast<double>(whole));
}

/// Over a row's height of one sample.
double mean_half_chord(double radius, int row) {
  constexpr int kSteps = 16;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double y = row + (i + 0.5) / kSteps - 0.5;
    sum += std::sqrt(std::max(0.0, radius * radius - y * y)) / kSteps;
  }
  return sum;
}

}  // namespace

DiscFilter::DiscFilter(double diameter_px) {
  const double radius = diameter_px / 2 * kSub;  // in samples
  if (radius < 0.5) return;                      // the samples themselves are coarser
  const int reach = static_cast<int>(std::floor(radius + 0.5));
  for (int row = -reach; row <= reach; ++row) {
    half_chords_.push_back(mean_half_chord(radius, row));
    area_ += 2 * half_chords_.back();
  }
  margin_px_ = static_cast<int>(std::ceil(radius / kSub)) + 1;
}

void DiscFilter::sum_up(std::span<const float> row, std::span<double> sums) {
  sums[0] = 0;
  for (std::size_t i = 0; i < row.size(); ++i) sums[i + 1] = sums[i] + static_cast<double>(row[i]);
}

float DiscFilter::average(std::span<const double* const> rows, std::size_t at) const {
  const double middle = static_cast<double>(at) + 0.5;
  double sum = 0;
  for (std::size_t i = 0; i < half_chords_.size(); ++i)
    sum += integral(rows[i], middle + half_chords_[i]) - integral(rows[i], middle - half_chords_[i]);
  return static_cast<float>(sum / area_);
}

}  // namespace roomcal::tools
