#include "tools/simulate/raster.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>

#include "tools/simulate/disc_filter.h"

namespace roomcal::tools {

namespace {

constexpr int kBandRows = 48;  // margins are computed twice per band: 10 % at the usual blur

/// Weights of the parts around a pixel, first part at -margin_px pixels.
struct Kernel {
  int margin_px = 0;
  std::vector<float> weights;
};

double normal_cdf(double x, double sigma) { return sigma > 0 ? 0.5 * std::erfc(-x / (sigma * std::sqrt(2.0))) : x > 0; }

/// Pixel square, Gaussian, motion. The parts are averages already, which the Gaussian gives up for it.
Kernel make_kernel(double sigma_px, double motion_px) {
  const double sigma = std::sqrt(std::max(0.0, sigma_px * sigma_px - 1.0 / (12 * kSub * kSub)));
  const int steps = motion_px > 0 ? 4 * kSub * static_cast<int>(std::ceil(motion_px)) : 1;
  Kernel kernel;
  kernel.margin_px = static_cast<int>(std::ceil(4.5 * sigma + motion_px / 2));
  const int count = (2 * kernel.margin_px + 1) * kSub;
  kernel.weights.assign(static_cast<std::size_t>(count), 0);
  for (int i = 0; i < count; ++i) {
    const double offset = (i + 0.5) / kSub - 0.5 - kernel.margin_px;
    double weight = 0;
    for (int step = 0; step < steps; ++step) {
      const double moved = offset + motion_px * ((step + 0.5) / steps - 0.5);
      weight += (normal_cdf(moved + 0.5, sigma) - normal_cdf(moved - 0.5, sigma)) / (steps * kSub);
    }
    kernel.weights[static_cast<std::size_t>(i)] = static_cast<float>(weight);
  }
  return kernel;
}

/// One row of pixels as rows of samples, sample by sample of a pixel: contiguous for the compiler.
using PartRow = std::array<std::vector<float>, kSub * kSub>;

/// Rows of samples, in focus or not. Rows must be asked for from above to below.
class PartRows {
 public:
  PartRows(const Radiance& radiance, const DiscFilter& disc, int margin_px, int width, int first_y)
      : radiance_(radiance),
        disc_(disc),
        margin_px_(margin_px),
        padded_(static_cast<std::size_t>(width + 2 * margin_px)),
        next_y_(first_y - disc.margin_px()) {
    for (auto& part : row_) part.assign(padded_, 0);
  }

  /// Of pixel row y, `margin_px` pixels wider than the picture on each side.
  const PartRow& at(int y) {
    if (disc_.active()) {
      defocus(y);
    } else {
      sample(y);
    }
    return row_;
  }

 private:
  void sample(int y) {
    PixelSamples samples{};
    for (std::size_t x = 0; x < padded_; ++x) {
      radiance_.sample(static_cast<int>(x) - margin_px_, y, samples);
      for (std::size_t i = 0; i < samples.size(); ++i) row_[i][x] = samples[i];
    }
  }

  /// Sums of the next pixel row's rows of samples, wider by the disc's margin.
  void sum_next() {
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

  void defocus(int y) {
    while (next_y_ <= y + disc_.margin_px()) sum_next();
    const std::size_t reach = static_cast<std::size_t>(disc_.reach());
    const std::size_t first =
        static_cast<std::size_t>(kSub * disc_.margin_px()) - reach;  // of the topmost row's window
    std::vector<const double*> window(2 * reach + 1);
    for (std::size_t j = 0; j < kSub; ++j) {
      for (std::size_t k = 0; k < window.size(); ++k) window[k] = sums_[first + j + k].data();
      for (std::size_t x = 0; x < padded_; ++x) {
        const std::size_t at = (x + static_cast<std::size_t>(disc_.margin_px())) * kSub;
        for (std::size_t i = 0; i < kSub; ++i) row_[j * kSub + i][x] = disc_.average(window, at + i);
      }
    }
  }

  const Radiance& radiance_;
  const DiscFilter& disc_;
  int margin_px_;
  std::size_t padded_;
  PartRow row_;
  int next_y_;                            ///< next pixel row to be summed up
  std::deque<std::vector<double>> sums_;  ///< of the latest rows of samples
};

/// One horizontal band of the picture: rows of parts, blurred along x, then along y.
class Band {
 public:
  Band(const Radiance& radiance, const DiscFilter& disc, const Kernel& along_x, const Kernel& along_y, int first_row,
       RadianceImage& image)
      : along_x_(along_x),
        along_y_(along_y),
        first_row_(first_row),
        image_(image),
        parts_(radiance, disc, along_x.margin_px, image.width, first_row - along_y.margin_px) {
    const int rows = std::min(kBandRows, image.height - first_row);
    const int part_rows = (rows + 2 * along_y.margin_px) * kSub;
    blurred_x_.assign(static_cast<std::size_t>(part_rows) * static_cast<std::size_t>(image.width), 0);
    for (int y = -along_y.margin_px; y < rows + along_y.margin_px; ++y) blur_row(y);
    for (int y = 0; y < rows; ++y) blur_column(y);
  }

 private:
  float* blurred_row(int part_row) { return &blurred_x_[static_cast<std::size_t>(part_row) * image_.width]; }

  void blur_row(int y) {
    const PartRow& parts = parts_.at(first_row_ + y);
    for (int j = 0; j < kSub; ++j) {
      float* out = blurred_row((y + along_y_.margin_px) * kSub + j);
      for (std::size_t k = 0; k < along_x_.weights.size(); ++k) {
        const float weight = along_x_.weights[k];
        const float* in = &parts[static_cast<std::size_t>(j) * kSub + k % kSub][k / kSub];
        for (int x = 0; x < image_.width; ++x) out[x] += weight * in[x];
      }
    }
  }

  void blur_column(int y) {
    float* out = &image_.at(0, first_row_ + y);
    for (std::size_t k = 0; k < along_y_.weights.size(); ++k) {
      const float weight = along_y_.weights[k];
      const float* in = blurred_row(y * kSub + static_cast<int>(k));
      for (int x = 0; x < image_.width; ++x) out[x] += weight * in[x];
    }
  }

  const Kernel& along_x_;
  const Kernel& along_y_;
  int first_row_;
  RadianceImage& image_;
  PartRows parts_;
  std::vector<float> blurred_x_;
};

}  // namespace

RadianceImage integrate(const Radiance& radiance, int width, int height, const Blur& blur) {
  RadianceImage image{width, height, {}};
  image.values.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  const Kernel along_x = make_kernel(blur.psf_sigma_px, blur.motion_px);
  const Kernel along_y = make_kernel(blur.psf_sigma_px, 0);
  const DiscFilter disc(blur.defocus_px);
  parallel_for((height + kBandRows - 1) / kBandRows,
               [&](int band) { Band(radiance, disc, along_x, along_y, band * kBandRows, image); });
  return image;
}

void parallel_for(int count, const std::function<void(int)>& work) {
  std::atomic<int> next = 0;
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto run = [&] {
    try {
      for (int i = next++; i < count; i = next++) work(i);
    } catch (...) {
      const std::lock_guard lock(failure_mutex);
      failure = std::current_exception();
      next = count;
    }
  };
  std::vector<std::thread> helpers;
  for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i) helpers.emplace_back(run);
  run();
  for (std::thread& helper : helpers) helper.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace roomcal::tools
