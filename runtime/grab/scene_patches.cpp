#include "runtime/grab/scene_patches.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace roomcal::grab {

namespace {

constexpr int kCellsX = 6, kCellsY = 4;
static_assert(kCellsX * kCellsY == static_cast<int>(kMaxPatches));
constexpr int kTries = 4;  // along each side of a cell
/// Least squared gradient, grey levels^2 a patch, in its weakest direction: with noise of 4 levels a shift is then
/// known to 4 / sqrt(40000) = 0.02 px.
constexpr double kMinTexture = 40'000;
/// A patch whose remainder is more than this share of its contrast shows something else than before.
constexpr double kChangedShare = 0.35;
constexpr double kMaxShift_px = 2;
/// A lamp may flicker; a patch that loses its contrast is hidden.
constexpr double kLeastGain = 0.4, kMostGain = 2.5;

using Parameters = Eigen::Matrix<double, 4, 1>;

struct Texture {
  double xx = 0, xy = 0, yy = 0;
  double weakest() const { return (xx + yy) / 2 - std::sqrt((xx - yy) * (xx - yy) / 4 + xy * xy); }
};

Texture texture_at(ImageView image, int x0, int y0) {
  Texture t;
  for (int y = 1; y < kPatchSize - 1; ++y) {
    const uint8_t* above = image.row(y0 + y - 1) + x0;
    const uint8_t* row = image.row(y0 + y) + x0;
    const uint8_t* below = image.row(y0 + y + 1) + x0;
    for (int x = 1; x < kPatchSize - 1; ++x) {
      const double gx = (row[x + 1] - row[x - 1]) / 2.0, gy = (below[x] - above[x]) / 2.0;
      t.xx += gx * gx;
      t.xy += gx * gy;
      t.yy += gy * gy;
    }
  }
  return t;
}

void copy_patch(ImageView image, int x0, int y0, ScenePatches::Patch& patch) {
  patch.x = x0;
  patch.y = y0;
  for (int y = 0; y < kPatchSize; ++y)
    std::copy_n(image.row(y0 + y) + x0, kPatchSize, patch.grey.begin() + y * kPatchSize);
}

void take_from_cell(ImageView image, int cell_x, int cell_y, ScenePatches& patches) {
  const int room_x = image.width() / kCellsX - kPatchSize, room_y = image.height() / kCellsY - kPatchSize;
  double best = kMinTexture;
  int best_x = -1, best_y = -1;
  for (int try_y = 0; try_y < kTries; ++try_y) {
    for (int try_x = 0; try_x < kTries; ++try_x) {
      const int x = cell_x * image.width() / kCellsX + room_x * try_x / (kTries - 1);
      const int y = cell_y * image.height() / kCellsY + room_y * try_y / (kTries - 1);
      const double weakest = texture_at(image, x, y).weakest();
      if (weakest <= best) continue;
      best = weakest;
      best_x = x;
      best_y = y;
    }
  }
  if (best_x < 0) return;
  ScenePatches::Patch patch;
  copy_patch(image, best_x, best_y, patch);
  static_cast<void>(patches.patches.push_back(patch));
}

struct PatchShift {
  double px = 0;
  bool changed = false;
};

PatchShift shift_of(const ScenePatches::Patch& patch, ImageView later) {
  const auto grey = [&](int x, int y) {
    return static_cast<double>(patch.grey[static_cast<std::size_t>(y * kPatchSize + x)]);
  };
  Eigen::Matrix4d H = Eigen::Matrix4d::Zero();
  Parameters b = Parameters::Zero();
  double sum = 0, squares = 0, later_squares = 0;
  int count = 0;
  for (int y = 1; y < kPatchSize - 1; ++y) {
    const uint8_t* row = later.row(patch.y + y) + patch.x;
    for (int x = 1; x < kPatchSize - 1; ++x, ++count) {
      const double level = grey(x, y), now = row[x];
      const Parameters J((grey(x + 1, y) - grey(x - 1, y)) / 2, (grey(x, y + 1) - grey(x, y - 1)) / 2, level, 1);
      H.selfadjointView<Eigen::Lower>().rankUpdate(J);
      b += J * now;
      sum += level;
      squares += level * level;
      later_squares += now * now;
    }
  }
  const Parameters solution = H.selfadjointView<Eigen::Lower>().ldlt().solve(b);
  const double left = std::max(0.0, later_squares - solution.dot(b)) / count;
  const double contrast = squares / count - sum / count * (sum / count);
  PatchShift shift;
  // later(x) = grey(x - motion): the picture moved against the gradient's coefficient.
  const double gain = solution[2];
  shift.px = std::hypot(solution[0], solution[1]) / std::max(kLeastGain, gain);
  shift.changed = !solution.allFinite() || !(gain > kLeastGain && gain < kMostGain) || shift.px > kMaxShift_px ||
                  left > kChangedShare * kChangedShare * contrast * gain * gain;
  return shift;
}

}  // namespace

void take_patches(ImageView image, ScenePatches& patches) {
  patches.patches.clear();
  if (image.width() < kCellsX * (kPatchSize + kTries) || image.height() < kCellsY * (kPatchSize + kTries)) return;
  for (int cell_y = 0; cell_y < kCellsY; ++cell_y)
    for (int cell_x = 0; cell_x < kCellsX; ++cell_x) take_from_cell(image, cell_x, cell_y, patches);
}

SceneMotion compare_patches(const ScenePatches& patches, ImageView later) {
  SceneMotion motion;
  FixedVector<double, kMaxPatches> shifts;
  for (const ScenePatches::Patch& patch : patches.patches) {
    if (patch.x + kPatchSize > later.width() || patch.y + kPatchSize > later.height()) continue;
    const PatchShift shift = shift_of(patch, later);
    ++motion.compared;
    if (shift.changed) {
      ++motion.changed;
    } else {
      static_cast<void>(shifts.push_back(shift.px));
    }
  }
  if (shifts.empty()) return motion;
  std::sort(shifts.begin(), shifts.end());
  motion.median_px = shifts[shifts.size() / 2];
  motion.largest_px = shifts.back();
  return motion;
}

bool has_moved(const SceneMotion& motion, const MotionLimits& limits) {
  return motion.median_px > limits.median_px ||
         static_cast<double>(motion.changed) > limits.changed_share * static_cast<double>(motion.compared);
}

}  // namespace roomcal::grab
