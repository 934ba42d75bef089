#include "tools/align/triangle_match.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/LU>

#include "tools/align/point_triangles.h"
#include "tools/common/random.h"

namespace roomcal::tools {

namespace {

constexpr std::size_t kRefined = 12;  // hypotheses that are refined before they are compared
// Two transforms are one when they differ by less.
constexpr double kSame_m = 0.1;
constexpr double kSame_rad = deg_to_rad(5);

struct Hypothesis {
  SE3 T_a_b;
  std::size_t count = 0;
};

class TriangleMatcher {
 public:
  TriangleMatcher(std::span<const SpacePoint> a, std::span<const SpacePoint> b, const TriangleMatchOptions& options)
      : a_(a),
        b_(b),
        options_(options),
        triangles_a_(list_triangles(a, options)),
        triangles_b_(list_triangles(b, options)) {
    const auto by_longest = [](const PointTriangle& s, const PointTriangle& t) { return s.edge_m[0] < t.edge_m[0]; };
    std::sort(triangles_a_.begin(), triangles_a_.end(), by_longest);
    choose_triangles_b();
    for (const SpacePoint& p : a) largest_a_m_ = std::max(largest_a_m_, std::sqrt(p.cov_m2.trace()));
    for (const SpacePoint& p : b) sigma_b_m_.push_back(std::sqrt(p.cov_m2.trace()));
  }

  std::optional<RigidMatch> run() {
    for (const PointTriangle& triangle : triangles_b_) {
      for (const PointTriangle* similar : closest_in_a(triangle)) take(hypothesis_of(*similar, triangle));
      // Nearly all of b placed: more draws cannot change the winner.
      if (!best_.empty() && 5 * best_.front().count >= 4 * b_.size()) break;
    }
    return refine();
  }

 private:
  /// The better determined half, in a seeded order: neighbours share corners, so a sorted list would try one corner of
  /// the view only.
  void choose_triangles_b() {
    const auto quality = [](const PointTriangle& t) {
      return (t.sigma_m[0] + t.sigma_m[1] + t.sigma_m[2]) / t.edge_m[2];
    };
    std::stable_sort(triangles_b_.begin(), triangles_b_.end(),
                     [&](const PointTriangle& s, const PointTriangle& t) { return quality(s) < quality(t); });
    if (triangles_b_.size() > options_.max_triangles) {
      triangles_b_.resize(std::max(options_.max_triangles, triangles_b_.size() / 2));
    }
    Random random(options_.seed);
    for (std::size_t i = triangles_b_.size(); i > 1; --i) std::swap(triangles_b_[i - 1], triangles_b_[random.below(i)]);
    triangles_b_.resize(std::min(triangles_b_.size(), options_.max_triangles));
  }

  std::vector<const PointTriangle*> closest_in_a(const PointTriangle& t) const {
    constexpr double kMaxTolerance_m = 0.15;
    const auto tolerance_m = [&](std::size_t i) {
      return std::min(kMaxTolerance_m, 3 * t.sigma_m[i] + 2 * options_.slack_m);
    };
    const auto before = [](const PointTriangle& s, double edge_m) { return s.edge_m[0] < edge_m; };
    auto it = std::lower_bound(triangles_a_.begin(), triangles_a_.end(), t.edge_m[0] - tolerance_m(0), before);
    std::vector<std::pair<double, const PointTriangle*>> found;
    for (; it != triangles_a_.end() && it->edge_m[0] <= t.edge_m[0] + tolerance_m(0); ++it) {
      double distance = 0;
      for (std::size_t i = 0; i < 3; ++i) distance += std::pow((it->edge_m[i] - t.edge_m[i]) / tolerance_m(i), 2);
      if (distance < 3) found.emplace_back(distance, &*it);
    }
    const std::size_t kept = std::min(found.size(), options_.candidates);
    std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(kept), found.end());
    std::vector<const PointTriangle*> closest;
    for (std::size_t i = 0; i < kept; ++i) closest.push_back(found[i].second);
    return closest;
  }

  Hypothesis hypothesis_of(const PointTriangle& in_a, const PointTriangle& in_b) const {
    std::array<Vec3, 3> p_a, p_b;
    for (std::size_t i = 0; i < 3; ++i) {
      p_a[i] = a_[in_a.corner[i]].p;
      p_b[i] = b_[in_b.corner[i]].p;
    }
    Hypothesis hypothesis{fit_rigid(p_a, p_b), 0};
    hypothesis.count = count(hypothesis.T_a_b);
    return hypothesis;
  }

  /// Points of b that come to lie near one of a: what the covariances allow, as a ball.
  std::size_t count(const SE3& T_a_b) const {
    std::size_t near = 0;
    for (std::size_t j = 0; j < b_.size(); ++j) {
      const Vec3 p_a = T_a_b * b_[j].p;
      const double gate_m = 2 * (options_.start_slack_m + std::min(0.1, sigma_b_m_[j] + largest_a_m_));
      near += std::any_of(a_.begin(), a_.end(),
                          [&](const SpacePoint& p) { return (p.p - p_a).squaredNorm() < gate_m * gate_m; });
    }
    return near;
  }

  /// Keeps the best few that differ.
  void take(const Hypothesis& hypothesis) {
    if (hypothesis.count < options_.min_pairs) return;
    if (best_.size() == kRefined && hypothesis.count <= best_.back().count) return;
    for (Hypothesis& other : best_) {
      if (!same(other.T_a_b, hypothesis.T_a_b)) continue;
      if (hypothesis.count <= other.count) return;
      other = hypothesis;
      sort_best();
      return;
    }
    best_.push_back(hypothesis);
    sort_best();
    if (best_.size() > kRefined) best_.pop_back();
  }

  void sort_best() {
    std::stable_sort(best_.begin(), best_.end(),
                     [](const Hypothesis& s, const Hypothesis& t) { return s.count > t.count; });
  }

  static bool same(const SE3& T, const SE3& U) {
    return (T.t - U.t).norm() < kSame_m && rotation_angle_between(T.R, U.R) < kSame_rad;
  }

  std::optional<RigidMatch> refine() const {
    std::optional<RigidMatch> winner;
    std::vector<RigidMatch> refined;
    for (const Hypothesis& hypothesis : best_) {
      RigidMatch match{hypothesis.T_a_b, {}, 0};
      tighten(match);
      refined.push_back(match);
      if (match.pairs.size() < options_.min_pairs) continue;
      if (!winner || match.pairs.size() > winner->pairs.size()) winner = match;
    }
    if (!winner) return winner;
    for (const RigidMatch& other : refined) {
      if (!same(other.T_a_b, winner->T_a_b)) winner->second_best = std::max(winner->second_best, other.pairs.size());
    }
    return winner;
  }

  void tighten(RigidMatch& match) const {
    double slack_m = options_.start_slack_m;
    constexpr int kRounds = 6;
    for (int round = 0; round < kRounds; ++round) {
      match.pairs = pair_points(a_, b_, match.T_a_b, slack_m, options_.max_chi2);
      if (match.pairs.size() < 3) return;
      match.T_a_b = fit(match);
      slack_m = std::max(options_.slack_m, 0.4 * slack_m);
    }
    match.pairs = pair_points(a_, b_, match.T_a_b, options_.slack_m, options_.max_chi2);
  }

  SE3 fit(const RigidMatch& match) const {
    std::vector<SpacePoint> a(a_.begin(), a_.end());
    for (SpacePoint& p : a) p.cov_m2 += options_.slack_m * options_.slack_m * Mat33::Identity();
    return fit_rigid_weighted(a, b_, match.pairs, match.T_a_b);
  }

  std::span<const SpacePoint> a_, b_;
  const TriangleMatchOptions& options_;
  std::vector<PointTriangle> triangles_a_, triangles_b_;
  double largest_a_m_ = 0;
  std::vector<double> sigma_b_m_;
  std::vector<Hypothesis> best_;
};

}  // namespace

PointPairs pair_points(std::span<const SpacePoint> a, std::span<const SpacePoint> b, const SE3& T_a_b, double slack_m,
                       double max_chi2) {
  struct Candidate {
    double chi2;
    std::size_t i, j;
  };
  std::vector<Candidate> candidates;
  const Mat33 slack_m2 = slack_m * slack_m * Mat33::Identity();
  for (std::size_t j = 0; j < b.size(); ++j) {
    const Vec3 p_a = T_a_b * b[j].p;
    const Mat33 cov_b_m2 = T_a_b.R * b[j].cov_m2 * T_a_b.R.transpose() + slack_m2;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const Vec3 off = a[i].p - p_a;
      // chi2 >= |off|^2 / trace: spares most of the inversions.
      const Mat33 cov_m2 = a[i].cov_m2 + cov_b_m2;
      if (off.squaredNorm() > max_chi2 * cov_m2.trace()) continue;
      const double chi2 = off.dot(cov_m2.inverse() * off);
      if (chi2 < max_chi2) candidates.push_back({chi2, i, j});
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& s, const Candidate& t) { return s.chi2 < t.chi2; });
  std::vector<bool> used_a(a.size()), used_b(b.size());
  PointPairs pairs;
  for (const Candidate& candidate : candidates) {
    if (used_a[candidate.i] || used_b[candidate.j]) continue;
    used_a[candidate.i] = used_b[candidate.j] = true;
    pairs.emplace_back(candidate.i, candidate.j);
  }
  std::sort(pairs.begin(), pairs.end(), [](const auto& s, const auto& t) { return s.second < t.second; });
  return pairs;
}

std::optional<RigidMatch> match_points(std::span<const SpacePoint> a, std::span<const SpacePoint> b,
                                       const TriangleMatchOptions& options) {
  if (a.size() < 3 || b.size() < 3) return std::nullopt;
  return TriangleMatcher(a, b, options).run();
}

}  // namespace roomcal::tools
