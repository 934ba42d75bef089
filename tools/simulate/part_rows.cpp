#include "tools/simulate/part_rows.h"

namespace roomcal::tools {

PartRows::PartRows(const Radiance& radiance, const DiscFilter& disc, int margin_px, int width, int first_y)
    : radiance_(radiance),
      disc_(disc),
      margin_px_(margin_px),
      padded_(static_cast<std::size_t>(width + 2 * margin_px)),
      next_y_(first_y - disc.margin_px()) {
  for (auto& part : row_) part.assign(padded_, 0);
}

const PartRow& PartRows::at(int y) {
  if (disc_.active()) {
    defocus(y);
  } else {
    sample(y);
  }
  return row_;
}

void PartRows::sample(int y) {
  PixelSamples samples{};
  for (std::size_t x = 0; x < padded_; ++x) {
    radiance_.sample(static_cast<int>(x) - margin_px_, y, samples);
    for (std::size_t i = 0; i < samples.size(); ++i) row_[i][x] = samples[i];
  }
}

void PartRows::sum_next() {
  const std::size_t wide = padded_ + 2 * static_cast<std::size_t>(disc_.margin_px());
  std::array<std::vector<float>, kSub> rows;
  for (auto& row : rows) row.resize(wide * kSub);
  PixelSamples samples{};
  for (std::size_t x = 0; x < wide; ++x) {
    radiance_.sample(static_cast<int>(x) - margin_px_ - disc_.margin_px(), next_y_, samples);
    for (std::size_t i = 0; i < samples.size(); ++i) rows[i / kSub][x * kSub + i % kSub] = samples[i];
  }
  for (const auto& row : rows) DiscFilter::sum_up(row, sums_.emplace_back(row.size() + 1));
  ++next_y_;
  while (sums_.size() > static_cast<std::size_t>(kSub * (2 * disc_.margin_px() + 1))) sums_.pop_front();
}

void PartRows::defocus(int y) {
  while (next_y_ <= y + disc_.margin_px()) sum_next();
  const std::size_t reach = static_cast<std::size_t>(disc_.reach());
  const std::size_t first = static_cast<std::size_t>(kSub * disc_.margin_px()) - reach;  // of the topmost row's window
  std::vector<const double*> window(2 * reach + 1);
  for (std::size_t j = 0; j < kSub; ++j) {
    for (std::size_t k = 0; k < window.size(); ++k) window[k] = sums_[first + j + k].data();
    for (std::size_t x = 0; x < padded_; ++x) {
      const std::size_t at = (x + static_cast<std::size_t>(disc_.margin_px())) * kSub;
      for (std::size_t i = 0; i < kSub; ++i) row_[j * kSub + i][x] = disc_.average(window, at + i);
    }
  }
}

}  // namespace roomcal::tools
