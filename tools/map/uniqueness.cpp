#include "tools/map/uniqueness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "tools/common/progress.h"

namespace roomcal::tools {

namespace {

constexpr int kNeighbours = 8;     // a camera of the paper's devices sees 15 to 60 markers; nine are a poor view
constexpr int kSurroundings = 14;  // of the other place: a neighbour's match need not be among the nearest eight
constexpr int kAligned = 3;        // neighbours tried as the one that falls in line
constexpr double kRoom = 2.5;      // what refinement may gain, in mean square; 4: same worst, medians 1 % less, slower
constexpr double kSamePlace_rad = 20 * kPi / 180;

/// The markers around one, nearest first, in a frame with z along the wall's normal and the marker at the origin.
struct Place {
  std::array<Vec3, kSurroundings + 1> around;       ///< the first is the middle one
  std::array<double, kSurroundings + 1> reach_m{};  ///< in the wall's plane
  std::array<double, kSurroundings + 1> bearing_rad{};
};

std::vector<std::size_t> nearest_to(const std::vector<map::MapMarker>& markers, std::size_t i, std::size_t count) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < markers.size(); ++k) {
    if (k != i) order.push_back(k);
  }
  const auto nearer = [&](std::size_t a, std::size_t b) {
    const double d_a = (markers[a].p_room - markers[i].p_room).squaredNorm();
    const double d_b = (markers[b].p_room - markers[i].p_room).squaredNorm();
    return d_a != d_b ? d_a < d_b : a < b;
  };
  count = std::min(count, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(), nearer);
  order.resize(count);
  return order;
}

// For a marker on no plane: the flattest direction of its surroundings, towards the middle of the room.
Vec3 normal_from(const std::vector<map::MapMarker>& markers, std::size_t i, const std::vector<std::size_t>& nearest) {
  if (markers[i].has_normal) return markers[i].normal_room;
  Mat33 scatter = Mat33::Zero();
  for (int k = 0; k < kNeighbours; ++k) {
    const Vec3 arm = markers[nearest[static_cast<std::size_t>(k)]].p_room - markers[i].p_room;
    scatter += arm * arm.transpose();
  }
  const Vec3 normal = Eigen::SelfAdjointEigenSolver<Mat33>(scatter).eigenvectors().col(0);
  Vec3 middle = Vec3::Zero();
  for (const map::MapMarker& marker : markers) middle += marker.p_room / static_cast<double>(markers.size());
  return normal.dot(middle - markers[i].p_room) < 0 ? Vec3(-normal) : normal;
}

Place place_at(const std::vector<map::MapMarker>& markers, std::size_t i) {
  const std::vector<std::size_t> nearest = nearest_to(markers, i, kSurroundings);
  const Vec3 n = normal_from(markers, i, nearest);
  const Vec3 u = n.unitOrthogonal();
  const Vec3 v = n.cross(u);
  Place place;
  place.around[0] = Vec3::Zero();
  for (std::size_t k = 1; k <= kSurroundings; ++k) {
    const Vec3 arm = markers[nearest[k - 1]].p_room - markers[i].p_room;
    place.around[k] = {u.dot(arm), v.dot(arm), n.dot(arm)};
    place.reach_m[k] = std::hypot(place.around[k].x(), place.around[k].y());
    place.bearing_rad[k] = std::atan2(place.around[k].y(), place.around[k].x());
  }
  return place;
}

Vec3 turned(const Vec3& p, double cos_turn, double sin_turn) {
  return {cos_turn * p.x() - sin_turn * p.y(), sin_turn * p.x() + cos_turn * p.y(), p.z()};
}

/// Hands out the markers of a place, each once: two markers cannot both be explained by one.
class Matcher {
 public:
  explicit Matcher(const Place& place) : place_(place) {}

  const Vec3& nearest_unused(const Vec3& p) {
    std::size_t best = 0;
    double best_m2 = std::numeric_limits<double>::max();
    for (std::size_t k = 0; k < place_.around.size(); ++k) {
      const double d_m2 = (place_.around[k] - p).squaredNorm();
      if (used_[k] || d_m2 >= best_m2) continue;
      best_m2 = d_m2;
      best = k;
    }
    used_[best] = true;
    return place_.around[best];
  }

 private:
  const Place& place_;
  std::array<bool, kSurroundings + 1> used_{};
};

/// A turn about the normal and a shift, and the mean square distance it leaves.
struct Overlay {
  double turn_rad = 0;
  Vec3 shift = Vec3::Zero();
  double mean_square_m2 = std::numeric_limits<double>::max();
};

constexpr std::size_t kCount = kNeighbours + 1;

// `give_up_m2` ends the sum early; the value is then only known to be larger.
double mean_square_m2(const Place& of, const Place& over, const Overlay& overlay, double give_up_m2) {
  const double c = std::cos(overlay.turn_rad), s = std::sin(overlay.turn_rad);
  Matcher matcher(over);
  double sum_m2 = 0;
  for (std::size_t k = 0; k < kCount && sum_m2 <= give_up_m2 * kCount; ++k) {
    const Vec3 p = turned(of.around[k], c, s) + overlay.shift;
    sum_m2 += (matcher.nearest_unused(p) - p).squaredNorm();
  }
  return sum_m2 / kCount;
}

// One round of closest points: the turn and shift of least squares for the matches of `overlay`.
Overlay refined(const Place& of, const Place& over, const Overlay& overlay) {
  const double c = std::cos(overlay.turn_rad), s = std::sin(overlay.turn_rad);
  Matcher matcher(over);
  std::array<Vec3, kCount> to;
  Vec3 from_mean = Vec3::Zero(), to_mean = Vec3::Zero();
  for (std::size_t k = 0; k < kCount; ++k) {
    to[k] = matcher.nearest_unused(turned(of.around[k], c, s) + overlay.shift);
    from_mean += of.around[k] / kCount;
    to_mean += to[k] / kCount;
  }
  double dot = 0, cross = 0;
  for (std::size_t k = 0; k < kCount; ++k) {
    const Vec3 a = of.around[k] - from_mean, b = to[k] - to_mean;
    dot += a.x() * b.x() + a.y() * b.y();
    cross += a.x() * b.y() - a.y() * b.x();
  }
  Overlay result;
  result.turn_rad = std::atan2(cross, dot);
  result.shift = to_mean - turned(from_mean, std::cos(result.turn_rad), std::sin(result.turn_rad));
  result.mean_square_m2 = mean_square_m2(of, over, result, std::numeric_limits<double>::max());
  return result;
}

bool is_same_place(const Overlay& overlay) {
  return std::abs(std::remainder(overlay.turn_rad, 2 * kPi)) < kSamePlace_rad;
}

/// Least mean square distance between two places, no more than `best_m2`.
double least_m2(const Place& of, const Place& over, bool same, double best_m2) {
  // A larger shift lays the middle over another marker: that is the next place's business, and if the places
  // overlap in the room it may even lead back to the identity.
  const double max_shift_m = over.around[1].norm() / 2;
  for (std::size_t a = 1; a <= kAligned; ++a) {
    for (std::size_t b = 1; b <= kSurroundings; ++b) {
      // The pair in line must itself be within what the best so far allows (in sum), with room for the refinement.
      const double gap_m = of.reach_m[a] - over.reach_m[b];
      if (gap_m * gap_m > kRoom * best_m2 * kCount) continue;
      Overlay overlay;
      overlay.turn_rad = over.bearing_rad[b] - of.bearing_rad[a];
      overlay.mean_square_m2 = mean_square_m2(of, over, overlay, kRoom * best_m2);
      if (overlay.mean_square_m2 > kRoom * best_m2) continue;
      for (int round = 0; round < 3; ++round) overlay = refined(of, over, overlay);
      if (overlay.shift.norm() > max_shift_m || (same && is_same_place(overlay))) continue;
      best_m2 = std::min(best_m2, overlay.mean_square_m2);
    }
  }
  return best_m2;
}

}  // namespace

std::optional<Uniqueness> measure_uniqueness(const std::vector<map::MapMarker>& markers) {
  if (markers.size() < kSurroundings + 4) return std::nullopt;
  std::vector<Place> places;
  for (std::size_t i = 0; i < markers.size(); ++i) places.push_back(place_at(markers, i));
  Uniqueness result;
  result.neighbours = kNeighbours;
  std::vector<double> figures_m;
  Progress progress("comparing places", places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    progress.step();
    double best_m2 = std::numeric_limits<double>::max() / 1e6;
    std::size_t other = i;
    for (std::size_t j = 0; j < places.size(); ++j) {
      const double m2 = least_m2(places[i], places[j], i == j, best_m2);
      if (m2 < best_m2) other = j;
      best_m2 = m2;
    }
    figures_m.push_back(std::sqrt(best_m2));
    if (figures_m.size() > 1 && figures_m.back() >= result.worst_m) continue;
    result.worst_m = figures_m.back();
    result.worst_id = markers[i].id;
    result.worst_other_id = markers[other].id;
  }
  std::nth_element(figures_m.begin(), figures_m.begin() + static_cast<std::ptrdiff_t>(figures_m.size() / 2),
                   figures_m.end());
  result.median_m = figures_m[figures_m.size() / 2];
  return result;
}

}  // namespace roomcal::tools
