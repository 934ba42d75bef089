#include "runtime/scan/print_fit.h"

#include <algorithm>
#include <cmath>

#include "runtime/scan/ray_cast.h"

namespace roomcal::scan {

namespace {

constexpr double kReachOfPrint = 1.2;    // radii; beyond it a print is wall, or the next sheet
constexpr double kCoarseStep_m = 0.015;  // a ring's width
constexpr double kFineStep_m = 0.002;
constexpr std::size_t kFineSteps = 8;  // to each side of the coarse answer
constexpr double kCurvatureStep_m = 0.006;
constexpr double kRunnerUp = 0.6;  // of the best gain; sheets hung in a grid come close to each other
constexpr double kElsewhere_m = 0.05;
constexpr double kFits_m = 0.06;  // a return this far off its face is no return from it
/// Sheets are not quite where they are thought to be, margins and walls are not of one grey: what is left is not white.
constexpr double kSigmaInflation = 1.5;

}  // namespace

std::size_t PrintMatcher::bytes() {
  return (kCoarsePoints + kFinePoints) * sizeof(Spot) + kMaxShifts * sizeof(AtShift) + 64;
}

Status PrintMatcher::build(Arena& scratch, PrintMatcher& matcher) {
  matcher.coarse_ = scratch.allocate_uninitialized<Spot>(kCoarsePoints);
  matcher.fine_ = scratch.allocate_uninitialized<Spot>(kFinePoints);
  matcher.at_shift_ = scratch.allocate<AtShift>(kMaxShifts);
  if (matcher.coarse_.empty() || matcher.fine_.empty() || matcher.at_shift_.empty())
    return out_of_arena("scan: scratch arena too small for prints");
  return ok_status();
}

namespace {

bool near_print(const Surface& surface, const Face& face, const Vec3& p_room, double reach_radii) {
  const double along_m = p_room[face.print_axis], reach_m = reach_radii * surface.largest_print_m();
  const auto prints = surface.prints_between(face, along_m - reach_m, along_m + reach_m);
  return std::any_of(prints.begin(), prints.end(),
                     [&](const Print& print) { return (p_room - print.p_room).norm() < reach_radii * print.radius_m; });
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
      if (near_only && !near_print(surface, surface.faces()[face], p_room + near_shift_m * slide, kMargin)) continue;
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

/// One print and one spot: the spot is on the print for the shifts s with |p + s slide - centre| < reach.
void PrintMatcher::add_print(const Spot& spot, const Print& print, uint32_t number, const Shifts& shifts) {
  constexpr float kPerRadius = 10;
  const Eigen::Vector3f slide(spot.slide[0], spot.slide[1], spot.slide[2]);
  const Eigen::Vector3f from =
      Eigen::Vector3f(spot.p_room[0], spot.p_room[1], spot.p_room[2]) - print.p_room.cast<float>();
  const float a = std::max(1e-12F, slide.squaredNorm()), b = from.dot(slide), c = from.squaredNorm();
  const auto radius_m = static_cast<float>(print.radius_m);
  const float reach_m = static_cast<float>(kReachOfPrint) * radius_m;
  const float discriminant = b * b - a * (c - reach_m * reach_m);
  if (!(discriminant > 0)) return;
  const float half_m = std::sqrt(discriminant) / a, middle_m = -b / a;
  const auto first_m = static_cast<float>(shifts.first_m), step_m = static_cast<float>(shifts.step_m);
  const float low = std::max(0.0F, std::ceil((middle_m - half_m - first_m) / step_m));
  const float high = std::min(static_cast<float>(shifts.count) - 1, std::floor((middle_m + half_m - first_m) / step_m));
  if (!(low <= high)) return;
  const auto value = static_cast<double>(spot.reflectivity);
  for (int k = static_cast<int>(low); k <= static_cast<int>(high); ++k) {
    AtShift& at = at_shift_[static_cast<std::size_t>(k)];
    if (at.last_spot == number) continue;
    at.last_spot = number;
    const float shift_m = first_m + step_m * static_cast<float>(k);
    const float distance_m = std::sqrt(std::max(0.0F, c + shift_m * (2 * b + shift_m * a)));
    const auto annulus = static_cast<std::size_t>(kPerRadius * distance_m / radius_m);
    at.annuli[std::min(annulus, kAnnuli - 1)].add(value);
    at.near_face.add(value);
  }
}

void PrintMatcher::add_spot(const Surface& surface, const Spot& spot, uint32_t number, const Shifts& shifts) {
  const Face& face = surface.faces()[spot.face];
  const double from_m = static_cast<double>(spot.p_room[face.print_axis]);
  const double slide = static_cast<double>(spot.slide[face.print_axis]);
  const double at_first_m = from_m + slide * shifts.first_m, at_last_m = from_m + slide * shifts.at(shifts.count - 1);
  const double margin_m = kReachOfPrint * surface.largest_print_m();
  const double low_m = std::min(at_first_m, at_last_m) - margin_m, high_m = std::max(at_first_m, at_last_m) + margin_m;
  for (const Print& print : surface.prints_between(face, low_m, high_m)) add_print(spot, print, number, shifts);
}

/// What is explained at several shifts. Beside the prints a face has one level, whatever the shift: only spots that
/// come to lie on a print are looked at one by one.
void PrintMatcher::explain(const Surface& surface, std::span<const Spot> spots, const Shifts& shifts,
                           std::span<Explained> explained) {
  const std::span<AtShift> at_shift = at_shift_.first(shifts.count);
  for (AtShift& at : at_shift) at = {};
  for (std::size_t k = 0; k < shifts.count; ++k) explained[k] = {0, 0, spots.size(), 0};
  double squares = 0, by_faces = 0;
  for (std::size_t f = 0; f < surface.faces().size(); ++f) {
    Level whole;
    for (AtShift& at : at_shift) at.near_face = {};
    for (std::size_t i = 0; i < spots.size(); ++i) {
      if (spots[i].face != f) continue;
      const auto value = static_cast<double>(spots[i].reflectivity);
      squares += value * value;
      whole.add(value);
      add_spot(surface, spots[i], static_cast<uint32_t>(i) + 1, shifts);
    }
    by_faces += whole.explained();
    for (std::size_t k = 0; k < shifts.count; ++k) {
      const Level& near = at_shift[k].near_face;
      explained[k].left -= Level{whole.sum - near.sum, whole.count - near.count}.explained();
      explained[k].near += static_cast<std::size_t>(near.count);
    }
  }
  for (std::size_t k = 0; k < shifts.count; ++k) {
    explained[k].left += squares;
    explained[k].total = squares - by_faces;
    for (const Level& level : at_shift[k].annuli) explained[k].left -= level.explained();
  }
}

PrintFit PrintMatcher::fit(const Surface& surface, const SweepView& view, const SensorModel& sensor,
                           const RangeState& state, const Vec3& axis_room, double reach_m) {
  PrintFit fit;
  if (surface.prints().empty()) return fit;
  Vec3 sum_room;
  const std::size_t coarse_count =
      take(surface, view, sensor, state, axis_room, stride_for(view, kCoarsePoints - 1), 0, false, coarse_, sum_room);
  const auto steps = std::min((kMaxShifts - 1) / 2, static_cast<std::size_t>(reach_m / kCoarseStep_m));
  const Shifts shifts{-kCoarseStep_m * static_cast<double>(steps), kCoarseStep_m, 2 * steps + 1};
  find_best(surface, coarse_.first(coarse_count), shifts, fit);
  if (!fit.clear || steps == 0) return fit;

  const std::size_t fine_count = take(surface, view, sensor, state, axis_room, stride_for(view, 4 * kFinePoints),
                                      fit.shift_m, true, fine_, sum_room);
  polish(surface, fine_.first(fine_count), fit);
  if (fit.clear) {
    fit.centre_lidar = state.T_room_lidar.inverse() * Vec3(sum_room / static_cast<double>(fine_count));
  }
  return fit;
}

/// The shift at which most is explained, and whether no other comes near it.
void PrintMatcher::find_best(const Surface& surface, std::span<const Spot> spots, const Shifts& shifts, PrintFit& fit) {
  std::array<Explained, kMaxShifts> explained;
  explain(surface, spots, shifts, explained);
  fit.informative = explained[0].total > 0;
  double runner_up = 0;
  fit.gain = -1;
  const auto gain = [&](std::size_t k) {
    const Explained& at = explained[k];
    return at.left <= 0 ? 0 : (at.total - at.left) / at.left * static_cast<double>(at.count);
  };
  for (std::size_t k = 0; k < shifts.count; ++k) {
    if (gain(k) <= fit.gain) continue;
    fit.gain = gain(k);
    fit.shift_m = shifts.at(k);
  }
  for (std::size_t k = 0; k < shifts.count; ++k) {
    if (std::abs(shifts.at(k) - fit.shift_m) >= kElsewhere_m) runner_up = std::max(runner_up, gain(k));
  }
  fit.clear = fit.gain > kSignificant && runner_up < kRunnerUp * fit.gain;
}

/// From the coarse shift to the best one, and its sigma.
void PrintMatcher::polish(const Surface& surface, std::span<const Spot> spots, PrintFit& fit) {
  std::array<Explained, kMaxShifts> at;
  const Shifts around{fit.shift_m - kFineSteps * kFineStep_m, kFineStep_m, 2 * kFineSteps + 1};
  explain(surface, spots, around, at);
  const auto least = std::min_element(at.begin(), at.begin() + around.count,
                                      [](const Explained& a, const Explained& b) { return a.left < b.left; });
  fit.shift_m = around.at(static_cast<std::size_t>(least - at.begin()));
  // A parabola through points far enough apart that single returns do not count; twice, to centre it.
  double curvature = 0;
  for (int round = 0; round < 2; ++round) {
    explain(surface, spots, {fit.shift_m - kCurvatureStep_m, kCurvatureStep_m, 3}, at);
    curvature = (at[0].left + at[2].left - 2 * at[1].left) / (kCurvatureStep_m * kCurvatureStep_m);
    if (!(curvature > 0)) break;
    const double move_m = 0.5 * (at[0].left - at[2].left) / (kCurvatureStep_m * curvature);
    fit.shift_m += std::clamp(move_m, -kCurvatureStep_m, kCurvatureStep_m);
  }
  fit.clear = curvature > 0 && spots.size() > 50;
  if (!fit.clear) return;
  explain(surface, spots, {fit.shift_m, kFineStep_m, 1}, at);
  const double variance = at[0].left / static_cast<double>(spots.size());
  fit.sigma_m = kSigmaInflation * std::sqrt(2 * variance / curvature);
  fit.points = static_cast<uint32_t>(at[0].near);
}

}  // namespace roomcal::scan
