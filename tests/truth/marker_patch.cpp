#include "tests/truth/marker_patch.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace roomcal::truth {
namespace {

// What is printed at a plane point: 1 paper, 0 ink; -1 off the sheet.
double printed(const MarkerPatch& patch, const Vec2& q) {
  if (std::fabs(q.x()) > patch.sheet_half_x || std::fabs(q.y()) > patch.sheet_half_y) return -1;
  const double radius = q.norm();
  switch (patch.print) {
    case MarkerPatch::Print::kRings: {
      double value = 1;
      for (const double edge : patch.radii) {
        if (radius < edge) value = 1 - value;
      }
      return value;
    }
    case MarkerPatch::Print::kFan:
      return radius < 1 && std::sin(9 * std::atan2(q.y(), q.x())) > 0 ? 0 : 1;
    case MarkerPatch::Print::kCheckerboard: {
      const auto cell = [](double v) { return static_cast<int>(std::floor(v / 0.3)); };
      return (cell(q.x()) + cell(q.y())) % 2 == 0 ? 0 : 1;
    }
    case MarkerPatch::Print::kText: {
      // Rows of blocks of pseudo-random width.
      const int line = static_cast<int>(std::floor((q.y() + 4) / 0.22));
      const int column = static_cast<int>(std::floor((q.x() + 4) / 0.09));
      const uint32_t mixed = (static_cast<uint32_t>(line) * 2654435761U) ^ (static_cast<uint32_t>(column) * 40503U);
      const bool between_lines = (q.y() + 4) / 0.22 - line > 0.6;
      return between_lines || ((mixed >> 7) * 2246822519U >> 31) != 0 ? 1 : 0;
    }
  }
  return 1;
}

double reflectance_at(const MarkerPatch& patch, const Mat33& H_plane_px, double x, double y) {
  if (patch.bar_half_px > 0 && std::fabs(patch.bar_normal.dot(Vec2{x, y}) - patch.bar_offset_px) < patch.bar_half_px) {
    return patch.bar_grey;
  }
  const Vec3 q = H_plane_px * Vec3{x, y, 1};
  const double value = printed(patch, q.head<2>() / q.z());
  const double level = value < 0 ? patch.background : patch.ink + (patch.paper - patch.ink) * value;
  return patch.shadow_normal.dot(Vec2{x, y}) > patch.shadow_offset_px ? level * patch.shadow : level;
}

// Cells of a grid kFine times finer than the pixels, with a rim for the blur.
constexpr int kFine = 6;

struct FineImage {
  int rim_px, width, height;  // rim in pixels; size in cells
  std::vector<double> level;

  double& at(int column, int row) {
    return level[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)];
  }
};

double integrate_cell(const MarkerPatch& patch, const Mat33& H_plane_px, double x, double y) {
  constexpr int kSamples = 4;
  constexpr double kHalf = 0.5 / kFine;
  const double first = reflectance_at(patch, H_plane_px, x - kHalf, y - kHalf);
  if (reflectance_at(patch, H_plane_px, x + kHalf, y - kHalf) == first &&
      reflectance_at(patch, H_plane_px, x - kHalf, y + kHalf) == first &&
      reflectance_at(patch, H_plane_px, x + kHalf, y + kHalf) == first) {
    return first;
  }
  double sum = 0;
  for (int k = 0; k < kSamples * kSamples; ++k) {
    const double u = (k % kSamples + 0.5) / kSamples - 0.5, v = (k / kSamples + 0.5) / kSamples - 0.5;
    sum += reflectance_at(patch, H_plane_px, x + u / kFine, y + v / kFine);
  }
  return sum / (kSamples * kSamples);
}

FineImage render_scene(const MarkerPatch& patch) {
  const Mat33 H_plane_px = patch.H_px_plane.inverse();
  FineImage fine;
  fine.rim_px = static_cast<int>(std::ceil(4 * patch.blur_px)) + 1;
  fine.width = (patch.width + 2 * fine.rim_px) * kFine;
  fine.height = (patch.height + 2 * fine.rim_px) * kFine;
  fine.level.resize(static_cast<std::size_t>(fine.width) * static_cast<std::size_t>(fine.height));
  for (int row = 0; row < fine.height; ++row) {
    for (int column = 0; column < fine.width; ++column) {
      const double x = (column + 0.5) / kFine - 0.5 - fine.rim_px, y = (row + 0.5) / kFine - 0.5 - fine.rim_px;
      const double light = 1 + patch.light_gradient.dot(Vec2{x, y} - patch.centre_px()) / patch.diameter_px;
      fine.at(column, row) = light * integrate_cell(patch, H_plane_px, x, y);
    }
  }
  return fine;
}

// Weights of the cells around a pixel's centre: the pixel's area blurred by the lens.
std::vector<double> pixel_kernel(double blur_px, int rim_px) {
  std::vector<double> kernel;
  const auto step = [&](double x) { return 0.5 * std::erfc(-x / (blur_px * std::sqrt(2.0))); };
  for (int k = -rim_px * kFine; k < (rim_px + 1) * kFine; ++k) {
    const double x = (k + 0.5) / kFine - 0.5;
    kernel.push_back((step(x + 0.5) - step(x - 0.5)) / kFine);
  }
  return kernel;
}

// Blur and pixel integration in one, separable, evaluated at the pixels only.
std::vector<double> expose(FineImage& fine, const MarkerPatch& patch) {
  const std::vector<double> kernel = pixel_kernel(patch.blur_px, fine.rim_px);
  std::vector<double> rows(static_cast<std::size_t>(patch.width) * static_cast<std::size_t>(fine.height));
  for (int row = 0; row < fine.height; ++row) {
    for (int x = 0; x < patch.width; ++x) {
      double sum = 0;
      for (std::size_t k = 0; k < kernel.size(); ++k) sum += kernel[k] * fine.at(x * kFine + static_cast<int>(k), row);
      rows[static_cast<std::size_t>(row * patch.width + x)] = sum;
    }
  }
  std::vector<double> image(static_cast<std::size_t>(patch.width) * static_cast<std::size_t>(patch.height));
  for (int y = 0; y < patch.height; ++y) {
    for (std::size_t k = 0; k < kernel.size(); ++k) {
      const double* row = &rows[(static_cast<std::size_t>(y * kFine) + k) * static_cast<std::size_t>(patch.width)];
      for (int x = 0; x < patch.width; ++x) image[static_cast<std::size_t>(y * patch.width + x)] += kernel[k] * row[x];
    }
  }
  return image;
}

class Noise {
 public:
  explicit Noise(uint32_t seed) : state_(seed * 0x9e3779b97f4a7c15ULL + 0x1234567ULL) {}
  double gaussian() {
    const double u = uniform(), v = uniform();
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * kPi * v);
  }

 private:
  double uniform() {  // splitmix64, in (0, 1]
    uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return (static_cast<double>((z ^ (z >> 31)) >> 11) + 1) * 0x1.0p-53;
  }
  uint64_t state_;
};

}  // namespace

Vec2 MarkerPatch::centre_px() const { return H_px_plane.col(2).head<2>() / H_px_plane(2, 2); }

Mat33 marker_homography(const Vec2& centre_px, double diameter_px, double slant_rad, double azimuth_rad,
                        double roll_rad, double focal_px) {
  const double distance = 2 * focal_px / diameter_px;  // in outer radii
  const auto turn = [](double angle) {
    Mat33 R;
    R << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
    return R;
  };
  Mat33 tilt;
  tilt << std::cos(slant_rad), 0, std::sin(slant_rad), 0, 1, 0, -std::sin(slant_rad), 0, std::cos(slant_rad);
  const Mat33 R = turn(azimuth_rad) * tilt * turn(roll_rad - azimuth_rad);
  Mat33 K;
  K << focal_px, 0, centre_px.x(), 0, focal_px, centre_px.y(), 0, 0, 1;
  Mat33 H;
  H.col(0) = R.col(0);
  H.col(1) = R.col(1);
  H.col(2) = Vec3{0, 0, distance};
  return K * H;
}

std::vector<double> render_clean(const MarkerPatch& patch) {
  FineImage fine = render_scene(patch);
  return expose(fine, patch);
}

std::vector<uint8_t> digitize(const std::vector<double>& clean, double noise_grey, uint32_t seed) {
  Noise noise(seed);
  std::vector<uint8_t> pixels;
  pixels.reserve(clean.size());
  for (const double level : clean) {
    pixels.push_back(static_cast<uint8_t>(std::clamp(std::lround(level + noise_grey * noise.gaussian()), 0L, 255L)));
  }
  return pixels;
}

std::vector<uint8_t> render(const MarkerPatch& patch) {
  return digitize(render_clean(patch), patch.noise_grey, patch.seed);
}

}  // namespace roomcal::truth
