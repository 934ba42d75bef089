#include "runtime/scan/print_fit.h"

#include <algorithm>
#include <cmath>

#include "runtime/scan/ray_cast.h"

namespace roomcal::scan {

namespace {

constexpr double kReachOfPrint = 1.2;    // radii; beyond it a print is wall, or the next sheet
constexpr double kCoarseStep_m = 0.015;  // a ring's width
constexpr int kMaxSteps = 70;            // a metre to each side
constexpr double kFineStep_m = 0.002;
constexpr int kFineSteps = 8;  // to each side of the coarse answer
constexpr double kCurvatureStep_m = 0.006;
constexpr double kRunnerUp = 0.6;  // of the best gain; sheets hung in a grid come close to each other
constexpr double kElsewhere_m = 0.05;
constexpr double kFits_m = 0.06;  // a return this far off its face is no return from it
/// Sheets are not quite where they are thought to be, margins and walls are not of one grey: what is left is not white.
constexpr double kSigmaInflation = 1.5;

constexpr std::size_t kNoAnnulus = SIZE_MAX;

}  // namespace

std::size_t PrintMatcher::bytes() { return (kCoarsePoints + kFinePoints) * sizeof(Spot) + 64; }

Status PrintMatcher::build(Arena& scratch, PrintMatcher& matcher) {
  matcher.coarse_ = scratch.allocate_uninitialized<Spot>(kCoarsePoints);
  matcher.fine_ = scratch.allocate_uninitialized<Spot>(kFinePoints);
  if (matcher.coarse_.empty() || matcher.fine_.empty()) return out_of_arena("scan: scratch arena too small for prints");
  return ok_status();
}

namespace {

/// Annulus of the print under a point, kNoAnnulus beside all prints. `width` annuli in a radius.
std::size_t annulus_at(const Surface& surface, std::size_t face, const Vec3& p_room, double reach_radii) {
  constexpr double kPerRadius = 10;
  for (const Print& print : surface.prints(surface.faces()[face])) {
    const double reach_m = reach_radii * print.radius_m;
    const double squared = (p_room - print.p_room).squaredNorm();
    if (squared < reach_m * reach_m) return static_cast<std::size_t>(kPerRadius * std::sqrt(squared) / print.radius_m);
  }
  return kNoAnnulus;
}

}  // namespace

std::size_t PrintMatcher::take(const Surface& surface, const SweepView& view, const SensorModel& sensor,
                               const RangeState& state, const Vec3& axis_room, std::size_t stride, double near_shift_m,
                               bool near_only, std::span<Spot> spots, Vec3& sum_room) {
  const SE3& T = state.T_room_lidar;
  const PosedSurface posed(surface, T);
  BlockHits hits;
  std::size_t count = 0;
  sum_room.setZero();
  for_each_block(view, sensor, stride, [&](const RayBlock& block) {
    posed.cast(block, hits);
    for (std::size_t i = 0; i < block.count && count < spots.size(); ++i) {
      const auto face = static_cast<std::size_t>(hits.face[i]);
      if (!(posed.height_m()[face] > 0)) continue;
      const double range_m = 1 / static_cast<double>(hits.inverse_m[i]);
      if (std::abs(static_cast<double>(block.range_m[i]) - range_m - state.offset_m[block.beam[i]]) > kFits_m) continue;
      const Vec3& normal = surface.faces()[face].normal_room;
      const Vec3 direction = T.R * block.direction_lidar(i);
      const Vec3 slide = axis_room - direction * (normal.dot(axis_room) / normal.dot(direction));
      const Vec3 p_room = T.t + range_m * direction;
      constexpr double kMargin = 2;  // radii: what belongs to the surroundings of a print
      if (near_only && annulus_at(surface, face, p_room + near_shift_m * slide, kMargin) == kNoAnnulus) continue;
      Spot& spot = spots[count++];
      for (int k = 0; k < 3; ++k) {
        spot.p_room[static_cast<std::size_t>(k)] = static_cast<float>(p_room[k]);
        spot.slide[static_cast<std::size_t>(k)] = static_cast<float>(slide[k]);
      }
      spot.reflectivity = static_cast<float>(block.reflectivity[i]);
      spot.face = static_cast<uint16_t>(face);
      sum_room += p_room;
    }
  });
  return count;
}

PrintMatcher::Explained PrintMatcher::explain(const Surface& surface, std::span<const Spot> spots, double shift_m) {
  struct Level {
    double sum = 0, count = 0;
    void add(double value) {
      sum += value;
      ++count;
    }
    double explained() const { return count == 0 ? 0 : sum * sum / count; }
  };
  std::array<Level, kAnnuli> annuli{};
  std::array<Level, kMaxFaces> beside{}, whole{};
  Explained explained;
  double squares = 0;
  for (const Spot& spot : spots) {
    Vec3 p_room;
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(i);
      p_room[i] = static_cast<double>(spot.p_room[k]) + shift_m * static_cast<double>(spot.slide[k]);
    }
    const double value = static_cast<double>(spot.reflectivity);
    const std::size_t annulus = annulus_at(surface, spot.face, p_room, kReachOfPrint);
    squares += value * value;
    whole[spot.face].add(value);
    if (annulus < kAnnuli) {
      annuli[annulus].add(value);
      ++explained.near;
    } else {
      beside[spot.face].add(value);
    }
  }
  explained.count = spots.size();
  explained.left = explained.total = squares;
  for (const Level& level : annuli) explained.left -= level.explained();
  for (const Level& level : beside) explained.left -= level.explained();
  for (const Level& level : whole) explained.total -= level.explained();
  return explained;
}

PrintFit PrintMatcher::fit(const Surface& surface, const SweepView& view, const SensorModel& sensor,
                           const RangeState& state, const Vec3& axis_room, double reach_m) {
  PrintFit fit;
  if (surface.prints().empty()) return fit;
  Vec3 sum_room;
  const std::size_t coarse_count =
      take(surface, view, sensor, state, axis_room, stride_for(view, kCoarsePoints - 1), 0, false, coarse_, sum_room);
  const std::span<const Spot> coarse = coarse_.first(coarse_count);
  const int steps = std::min(kMaxSteps, static_cast<int>(reach_m / kCoarseStep_m));
  fit.informative = explain(surface, coarse, 0).total > 0;
  const auto gain_at = [&](double shift_m) {
    const Explained at = explain(surface, coarse, shift_m);
    return at.left <= 0 ? 0 : (at.total - at.left) / at.left * static_cast<double>(at.count);
  };
  std::array<double, 2 * kMaxSteps + 1> gains{};
  double best_gain = -1, runner_up = 0;
  for (int step = -steps; step <= steps; ++step) {
    const double gain = gains[static_cast<std::size_t>(step + steps)] = gain_at(kCoarseStep_m * step);
    if (gain <= best_gain) continue;
    best_gain = gain;
    fit.shift_m = kCoarseStep_m * step;
  }
  for (int step = -steps; step <= steps; ++step) {
    if (std::abs(kCoarseStep_m * step - fit.shift_m) < kElsewhere_m) continue;
    runner_up = std::max(runner_up, gains[static_cast<std::size_t>(step + steps)]);
  }
  fit.gain = best_gain;
  fit.clear = best_gain > kSignificant && runner_up < kRunnerUp * best_gain;
  if (!fit.clear || steps == 0) return fit;

  const std::size_t fine_count = take(surface, view, sensor, state, axis_room, stride_for(view, 4 * kFinePoints),
                                      fit.shift_m, true, fine_, sum_room);
  const std::span<const Spot> fine = fine_.first(fine_count);
  const double coarse_shift_m = fit.shift_m;
  double least = 1e300;
  for (int step = -kFineSteps; step <= kFineSteps; ++step) {
    const double shift_m = coarse_shift_m + kFineStep_m * step;
    const double left = explain(surface, fine, shift_m).left;
    if (left >= least) continue;
    least = left;
    fit.shift_m = shift_m;
  }
  // A parabola through points far enough apart that single returns do not count; twice, to centre it.
  double curvature = 0;
  for (int round = 0; round < 2; ++round) {
    const double left = explain(surface, fine, fit.shift_m - kCurvatureStep_m).left;
    const double right = explain(surface, fine, fit.shift_m + kCurvatureStep_m).left;
    const double middle = explain(surface, fine, fit.shift_m).left;
    curvature = (left + right - 2 * middle) / (kCurvatureStep_m * kCurvatureStep_m);
    if (!(curvature > 0)) break;
    const double move_m = 0.5 * (left - right) / (kCurvatureStep_m * curvature);
    fit.shift_m += std::clamp(move_m, -kCurvatureStep_m, kCurvatureStep_m);
  }
  fit.clear = curvature > 0 && fine_count > 50;
  if (!fit.clear) return fit;
  const Explained at = explain(surface, fine, fit.shift_m);
  const double variance = at.left / static_cast<double>(fine_count);
  fit.sigma_m = kSigmaInflation * std::sqrt(2 * variance / curvature);
  fit.points = static_cast<uint32_t>(at.near);
  fit.centre_lidar = state.T_room_lidar.inverse() * Vec3(sum_room / static_cast<double>(fine_count));
  return fit;
}

}  // namespace roomcal::scan
