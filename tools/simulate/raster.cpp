#include "tools/simulate/raster.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include "tools/simulate/disc_filter.h"
#include "tools/simulate/part_rows.h"

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
