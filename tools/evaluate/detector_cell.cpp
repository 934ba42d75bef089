#include "tools/evaluate/detector_cell.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "runtime/marker/detector.h"
#include "tools/common/error.h"
#include "tools/evaluate/detector_bound.h"
#include "tools/simulate/sensor.h"

namespace roomcal::tools {

namespace {

constexpr double kBlur_px = 0.6;
constexpr int kBoundMarkers = 8;  // the bound varies with azimuth by a few percent; this is its average
constexpr int kMaxImages = 6;

camera::Intrinsics lens_for(const CellSpec& spec) {
  const double scale = std::max(1.0, 1.9 * spec.diameter_px / 960);
  const int width = static_cast<int>(1280 * scale), height = static_cast<int>(960 * scale);
  camera::Intrinsics lens{camera::Model::kPinholeRadtan,
                          width,
                          height,
                          1500 * scale,
                          1500 * scale,
                          (width - 1) / 2.0,
                          (height - 1) / 2.0,
                          {}};
  if (spec.fisheye) {
    lens.model = camera::Model::kKannalaBrandt;
    lens.fx_px = lens.fy_px = 614;
    lens.distortion = {-0.02, 0.005, -0.002, 4e-4};
  }
  return lens;
}

FieldOptions field_for(const CellSpec& spec, uint64_t seed) {
  FieldOptions options;
  options.lens = lens_for(spec);
  options.diameter_px = spec.diameter_px;
  options.slant_rad = deg_to_rad(spec.slant_deg);
  options.gradient = spec.gradient;
  options.ring_radii = spec.ring_radii;
  options.seed = seed;
  return options;
}

cv::Mat noisy(const RadianceImage& grey, double noise_sigma, uint64_t seed) {
  ImageSensor sensor;
  sensor.noise_sigma = noise_sigma;
  sensor.shot_share = 0;  // the bound is for equal noise everywhere
  sensor.seed = seed;
  return digitize(grey, sensor);
}

struct Detected {
  std::vector<marker::Detection> ok;
  double time_ms = 0;
  bool over_capacity = false;
};

Detected run_detector(const cv::Mat& image, std::size_t capacity, std::vector<std::byte>& scratch) {
  const std::size_t needed = marker::detector_scratch_bytes(image.cols, image.rows);
  if (scratch.size() < needed) scratch.resize(needed);
  Arena arena{std::span<std::byte>(scratch)};
  Detected detected;
  detected.ok.resize(capacity);
  std::size_t count = 0;
  const ImageView view(image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step));
  const auto start = std::chrono::steady_clock::now();
  const Status status = marker::detect(view, marker::DetectorOptions{}, arena, detected.ok, count);
  detected.time_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  detected.over_capacity = status.code() == StatusCode::kCapacity;  // what it found is valid; the rest are misses
  if (!detected.over_capacity) require(status, "detector");
  detected.ok.resize(count);
  std::erase_if(detected.ok, [](const auto& d) { return d.status != marker::DetectionStatus::kOk; });
  return detected;
}

/// Gives each detection to the nearest marker, and each marker its nearest detection.
void judge(const std::vector<marker::Detection>& detections, const MarkerField& field, CellResult& result) {
  const double reach_px = std::max(1.0, 0.1 * field.options().diameter_px);
  std::vector<bool> taken(field.markers().size(), false);
  result.truths += static_cast<int>(field.markers().size());
  for (const marker::Detection& detection : detections) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < field.markers().size(); ++i) {
      const auto distance = [&](std::size_t k) { return (field.markers()[k].centre_px - detection.centre_px).norm(); };
      if (distance(i) < distance(best)) best = i;
    }
    const Vec2 error = detection.centre_px - field.markers()[best].centre_px;
    if (error.norm() > reach_px || taken[best]) {
      ++result.false_alarms;
      continue;
    }
    taken[best] = true;
    ++result.found;
    result.sum_error_px += error;
    result.sum_error_error_px2 += error * error.transpose();
    result.sum_nees += error.dot(detection.cov_px2.inverse() * error);
  }
}

void set_bounds(const MarkerField& field, std::vector<CellResult>& results) {
  const int count = std::min(kBoundMarkers, static_cast<int>(field.markers().size()));
  std::vector<CentreBound> bounds(static_cast<std::size_t>(count));
  parallel_for(count, [&](int i) {
    const std::size_t k = static_cast<std::size_t>(i) * field.markers().size() / static_cast<std::size_t>(count);
    bounds[static_cast<std::size_t>(i)] = centre_bound(field.markers()[k], field.camera(), field.options(), kBlur_px);
  });
  for (CellResult& result : results) {
    const double variance = result.spec.noise_sigma * result.spec.noise_sigma + 1.0 / 12;  // and the rounding
    for (const CentreBound& bound : bounds) {
      result.bound_px2 += variance * bound.cov_px2.trace() / count;
      result.bound_full_px2 += variance * bound.cov_full_px2.trace() / count;
    }
  }
}

}  // namespace

double CellResult::rms_px() const { return std::sqrt(sum_error_error_px2.trace() / std::max(1, found)); }

double CellResult::bound_rms_px() const { return std::sqrt(bound_px2); }

double CellResult::mean_error_sigma_px() const {
  if (found < 2) return 1e9;
  const Mat22 covariance = sum_error_error_px2 / found - mean_error_px() * mean_error_px().transpose();
  return std::sqrt(std::max(covariance(0, 0), covariance(1, 1)) / found);
}

double empty_image_ms_per_mp(std::vector<std::byte>& scratch) {
  constexpr int kRuns = 9;
  FieldOptions options = field_for({}, 1);
  options.empty = true;
  const RadianceImage grey = integrate(MarkerField(options), options.lens.width_px, options.lens.height_px, {});
  const cv::Mat image = noisy(grey, 2, 1);
  double best_ms = 1e9;
  for (int run = 0; run < kRuns; ++run) best_ms = std::min(best_ms, run_detector(image, 100, scratch).time_ms);
  return best_ms / (1e-6 * image.rows * image.cols);
}

CellResult pool(const std::vector<CellResult>& cells) {
  CellResult sum;
  for (const CellResult& cell : cells) {
    if (sum.truths == 0)
      sum = CellResult{.spec = cell.spec, .bound_px2 = cell.bound_px2, .bound_full_px2 = cell.bound_full_px2};
    sum.truths += cell.truths;
    sum.found += cell.found;
    sum.false_alarms += cell.false_alarms;
    sum.sum_error_px += cell.sum_error_px;
    sum.sum_error_error_px2 += cell.sum_error_error_px2;
    sum.sum_nees += cell.sum_nees;
    sum.detect_ms += cell.detect_ms;
    sum.over_capacity += cell.over_capacity;
    sum.megapixels += cell.megapixels;
  }
  return sum;
}

std::vector<CellResult> run_cells(const CellSpec& spec, const std::vector<double>& noises, int target_markers,
                                  std::vector<std::byte>& scratch) {
  std::vector<CellResult> results;
  for (const double noise : noises) {
    results.push_back({.spec = spec});
    results.back().spec.noise_sigma = noise;
  }
  for (int image = 0; image < kMaxImages && results[0].truths < target_markers; ++image) {
    const auto seed = static_cast<uint64_t>(1000 * image) + 1;
    const MarkerField field(field_for(spec, seed));
    const int width = field.options().lens.width_px, height = field.options().lens.height_px;
    const RadianceImage grey = integrate(field, width, height, {.psf_sigma_px = kBlur_px});
    for (std::size_t i = 0; i < noises.size(); ++i) {
      CellResult& result = results[i];
      const Detected detected =
          run_detector(noisy(grey, noises[i], seed + i + 1), 4 * field.markers().size() + 100, scratch);
      judge(detected.ok, field, result);
      result.detect_ms += detected.time_ms;
      result.over_capacity += detected.over_capacity ? 1 : 0;
      result.megapixels += 1e-6 * width * height;
    }
    if (image == 0) set_bounds(field, results);
  }
  return results;
}

}  // namespace roomcal::tools
