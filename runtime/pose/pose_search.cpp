#include "runtime/pose/pose_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

namespace roomcal::pose {
namespace {

/// Part of the map's most frequent triples that is tried with every image triangle before the next part: two, six, then
/// all triples per marker. The first hold more than half of the image triangles of any view.
constexpr std::size_t kTriplesPerMarker[] = {2, 6, 65535};
/// Inlier gates of unpolished poses, as a multiple of the final one.
constexpr double kNeighbourGate = 4.0;
constexpr double kHypothesisGate = 3.0;
/// Neighbours that must be seen before the whole map is matched: one in a hundred wrong poses gets that far.
constexpr int kNeighboursWanted = 2;
/// Support that is worth a polish: one marker beyond the three that made the pose.
constexpr int kMinSupport = 4;
/// Triangles of the accepted pose that are looked for elsewhere in the room.
constexpr int kChallenges = 10;
/// Poses nearer than this run into the same minimum.
constexpr double kSameBasin_m = 0.02;
constexpr double kSameBasin_rad = 0.01;

template <typename T>
std::array<T, 3> rotated(const std::array<T, 3>& t, std::size_t by) {
  return {t[by % 3], t[(by + 1) % 3], t[(by + 2) % 3]};
}

P3pBearings prepare(const SightSet& set, const Triple& sight) {
  const std::array<Vec3, 3> bearing = {set.sights[sight[0]].bearing_cam, set.sights[sight[1]].bearing_cam,
                                       set.sights[sight[2]].bearing_cam};
  return P3pBearings(std::span<const Vec3, 3>(bearing));
}

/// xorshift64*: [Marsaglia 2003, Vigna 2016].
class Random {
 public:
  explicit Random(uint32_t seed) : state_(0x9E3779B97F4A7C15ULL ^ (static_cast<uint64_t>(seed) << 17U)) {}
  std::size_t below(std::size_t n) {
    state_ ^= state_ >> 12U;
    state_ ^= state_ << 25U;
    state_ ^= state_ >> 27U;
    return static_cast<std::size_t>((state_ * 0x2545F4914F6CDD1DULL) >> 33U) % n;
  }

 private:
  uint64_t state_;
};

/// Edge lengths of an image triangle from the sizes of its rings, with their tolerances.
struct SizedEdges {
  std::array<double, 3> length_m{};
  std::array<double, 3> tolerance_m{};
  bool known = false;
};

SizedEdges sized_edges(const SightSet& set, const Triple& sight, double radius_m) {
  SizedEdges edges;
  std::array<Vec3, 3> bearing;
  std::array<double, 3> range_m{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Sight& s = set.sights[sight[i]];
    if (s.semi_major_rad <= 0) return edges;
    bearing[i] = s.bearing_cam;
    range_m[i] = radius_m / std::tan(s.semi_major_rad);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const std::size_t k = (i + 2) % 3;
    const Vec3 edge = range_m[j] * bearing[j] - range_m[k] * bearing[k];
    const double length = edge.norm();
    edges.length_m[i] = length;
    // 4 % of each range (two sigmas of a ring's size), as far as it lies along the edge, and 5 % of the edge itself.
    const double along = std::hypot(edge.dot(bearing[j]) * range_m[j], edge.dot(bearing[k]) * range_m[k]) / length;
    edges.tolerance_m[i] = 0.05 * length + 0.04 * along;
  }
  edges.known = true;
  return edges;
}

bool fits(const SizedEdges& edges, const std::array<float, 3>& edge_m, std::size_t rotation) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (std::abs(static_cast<double>(edge_m[(i + rotation) % 3]) - edges.length_m[i]) > edges.tolerance_m[i])
      return false;
  }
  return true;
}

}  // namespace

PoseSearch::PoseSearch(const Matcher& matcher, const LocateOptions& options, std::size_t observations,
                       std::span<Triple> triangles, std::span<uint16_t> marker_of_sight, std::span<double> work)
    : matcher_(matcher),
      options_(options),
      observations_(static_cast<int>(observations)),
      triangles_(triangles),
      marker_of_sight_(marker_of_sight),
      work_(work) {}

void PoseSearch::run() {
  shuffle();
  if (matcher_.set().has_ellipses && matcher_.index().common_radius_m() > 0) {
    search_by_size();
  } else {
    search_by_frequency();
  }
}

void PoseSearch::shuffle() {
  Random random(options_.seed);
  for (std::size_t i = triangles_.size(); i > 1; --i) std::swap(triangles_[i - 1], triangles_[random.below(i)]);
}

void PoseSearch::search_by_size() {
  for (const Triple& triangle : triangles_) {
    if (try_sizes(triangle)) return;
  }
}

void PoseSearch::search_by_frequency() {
  const std::size_t all = matcher_.index().triples().size();
  std::size_t first = 0;
  for (const std::size_t per_marker : kTriplesPerMarker) {
    const std::size_t last = std::min(per_marker * matcher_.index().markers().size(), all);
    for (const Triple& triangle : triangles_) {
      if (try_triples(triangle, first, last)) return;
    }
    first = last;
  }
}

bool PoseSearch::try_sizes(const Triple& triangle) {
  const SizedEdges edges = sized_edges(matcher_.set(), triangle, matcher_.index().common_radius_m());
  if (!edges.known) return false;
  double low_m = 0;
  double high_m = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    low_m = std::max(low_m, edges.length_m[i] - edges.tolerance_m[i]);
    high_m = std::max(high_m, edges.length_m[i] + edges.tolerance_m[i]);
  }
  const P3pBearings bearings = prepare(matcher_.set(), triangle);
  for (const uint16_t number : matcher_.index().with_longest_edge(low_m, high_m)) {
    const map::IndexedTriple& entry = matcher_.index().triples()[number];
    for (std::size_t r = 0; r < 3; ++r) {
      if (fits(edges, entry.edge_m, r) && try_pair(bearings, triangle, rotated(entry.marker, r))) return true;
    }
  }
  return false;
}

bool PoseSearch::try_triples(const Triple& triangle, std::size_t first, std::size_t last) {
  const P3pBearings bearings = prepare(matcher_.set(), triangle);
  for (std::size_t number = first; number < last; ++number) {
    const map::IndexedTriple& entry = matcher_.index().triples()[number];
    for (std::size_t r = 0; r < 3; ++r) {
      if (try_pair(bearings, triangle, rotated(entry.marker, r))) return true;
    }
  }
  return false;
}

bool PoseSearch::try_pair(const P3pBearings& bearings, const Triple& sight, const map::MarkerTriple& marker) {
  const std::span<const map::IndexedMarker> markers = matcher_.index().markers();
  const std::array<Vec3, 3> point_room = {markers[marker[0]].p_room, markers[marker[1]].p_room,
                                          markers[marker[2]].p_room};
  if (!solve_p3p(bearings, std::span<const Vec3, 3>(point_room), poses_).ok()) return false;
  for (const SE3& T_room_cam : poses_) verify(T_room_cam, sight, marker);
  return done();
}

void PoseSearch::verify(const SE3& T_room_cam, const Triple& sight, const map::MarkerTriple& marker) {
  ++hypotheses_;
  if (!matcher_.is_plausible(T_room_cam, sight, marker)) return;
  if (matcher_.neighbours_seen(T_room_cam, marker, kNeighbourGate, kNeighboursWanted) < kNeighboursWanted) return;
  if (is_known(T_room_cam)) return;
  const Support support = matcher_.match(T_room_cam, kHypothesisGate, marker_of_sight_, work_);
  if (support.inliers >= kMinSupport && support.log_likelihood > 0) polish_and_record(T_room_cam);
}

void PoseSearch::polish_and_record(const SE3& T_room_cam) {
  PolishedPose pose;
  if (!polish(matcher_, T_room_cam, marker_of_sight_, work_, pose).ok()) return;
  if (pose.support.inliers >= kMinSupport && pose.support.log_likelihood > 0) record(pose);
}

bool PoseSearch::is_known(const SE3& T_room_cam) const {
  return std::any_of(found_.begin(), found_.end(), [&](const PolishedPose& known) {
    return (known.T_room_cam.t - T_room_cam.t).norm() < kSameBasin_m &&
           rotation_angle_between(known.T_room_cam.R, T_room_cam.R) < kSameBasin_rad;
  });
}

void PoseSearch::record(const PolishedPose& pose) {
  for (std::size_t i = 0; i < found_.size(); ++i) {
    if (is_clearly_another(found_[i], pose.T_room_cam)) continue;
    if (found_[i].support.log_likelihood >= pose.support.log_likelihood) return;
    std::copy(found_.begin() + i + 1, found_.end(), found_.begin() + i);  // the same pose, better
    found_.pop_back();
    break;
  }
  if (found_.full()) {
    if (found_.back().support.log_likelihood >= pose.support.log_likelihood) return;
    found_.pop_back();
  }
  static_cast<void>(found_.push_back(pose));
  for (std::size_t i = found_.size() - 1; i > 0; --i) {
    if (found_[i - 1].support.log_likelihood >= found_[i].support.log_likelihood) break;
    std::swap(found_[i - 1], found_[i]);
  }
}

double PoseSearch::log_odds(const Support& support) const {
  // Three inliers made the pose and prove nothing; every hypothesis tried was another chance to be lucky.
  const double clutter = 1.6 * (observations_ - support.inliers);
  const double per_inlier = (support.log_likelihood + clutter) / std::max(support.inliers, 1);
  return support.log_likelihood - 3.0 * per_inlier - std::log(1.0 + hypotheses_);
}

bool PoseSearch::accepts(const Support& support) const {
  return support.inliers >= options_.min_inliers && support.inliers >= options_.min_inlier_ratio * observations_ &&
         log_odds(support) >= options_.min_log_odds;
}

bool PoseSearch::done() const {
  return hypotheses_ >= options_.max_hypotheses || (!found_.empty() && accepts(found_[0].support));
}

void PoseSearch::challenge() {
  if (found_.empty()) return;
  const PolishedPose best = found_[0];
  try_mirror_pose();
  int challenges = 0;
  for (const Triple& triangle : triangles_) {
    matcher_.match(best.T_room_cam, 1.0, marker_of_sight_, work_);
    const map::MarkerTriple marker = {marker_of_sight_[triangle[0]], marker_of_sight_[triangle[1]],
                                      marker_of_sight_[triangle[2]]};
    if (std::find(marker.begin(), marker.end(), kNoMarker) != marker.end()) continue;
    challenge_triangle(triangle, marker);
    if (++challenges == kChallenges) return;
  }
}

void PoseSearch::challenge_triangle(const Triple& triangle, const map::MarkerTriple& marker) {
  const map::TriangleIndex& index = matcher_.index();
  const bool sized = matcher_.set().has_ellipses && index.common_radius_m() > 0;
  SizedEdges edges;
  for (std::size_t i = 0; i < 3; ++i) {
    edges.length_m[i] =
        (index.markers()[marker[(i + 1) % 3]].p_room - index.markers()[marker[(i + 2) % 3]].p_room).norm();
  }
  const double longest_m = *std::max_element(edges.length_m.begin(), edges.length_m.end());
  constexpr double kSameEdge = 0.06;
  const P3pBearings bearings = prepare(matcher_.set(), triangle);
  for (const map::IndexedTriple& entry : index.triples()) {
    const double entry_longest_m = longest_edge_m(entry);
    // Most end here: where all edges are alike, so are the longest.
    if (sized && std::abs(entry_longest_m - longest_m) >= kSameEdge * longest_m) continue;
    const double scale = sized ? 1.0 : entry_longest_m / longest_m;  // without sizes, a larger copy looks the same
    for (std::size_t r = 0; r < 3; ++r) {
      bool same = true;
      for (std::size_t i = 0; i < 3 && same; ++i) {
        const double expected_m = scale * edges.length_m[i];
        same = std::abs(static_cast<double>(entry.edge_m[(i + r) % 3]) - expected_m) < kSameEdge * expected_m;
      }
      const map::MarkerTriple other = rotated(entry.marker, r);
      if (!same || other == marker) continue;
      const std::array<Vec3, 3> point_room = {index.markers()[other[0]].p_room, index.markers()[other[1]].p_room,
                                              index.markers()[other[2]].p_room};
      if (!solve_p3p(bearings, std::span<const Vec3, 3>(point_room), poses_).ok()) continue;
      for (const SE3& T_room_cam : poses_) verify(T_room_cam, triangle, other);
    }
  }
}

bool is_clearly_another(const PolishedPose& pose, const SE3& T_room_cam_other) {
  const Vec6 difference = se3_log(pose.T_room_cam.inverse() * T_room_cam_other);
  constexpr double kSigmas = 6.0;
  return difference.dot(pose.cov.ldlt().solve(difference)) > kSigmas * kSigmas;
}

}  // namespace roomcal::pose
