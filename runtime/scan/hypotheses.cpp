#include "runtime/scan/hypotheses.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "runtime/scan/ray_cast.h"

namespace roomcal::scan {

namespace {

constexpr float kUnit_m = 0.05F;  // coarse poses are some centimetres off
constexpr float kInFront = 1, kBehind = 2, kNothing = 0.6F;
constexpr double kHopeless = 10;          // no score is so bad
constexpr double kPriorGate = 34;         // chi-square with 6 degrees, 1e-5
constexpr double kAngleCos = 0.05;        // how well angles between planes agree, in cosine
constexpr double kNormalSlack_rad = 0.1;  // of a single plane's normal, beside the rotation of two or three
constexpr double kSame_m = 0.12;
constexpr double kSame_rad = 0.05;
constexpr std::size_t kTopPlanes = 6;  // of the sweep
constexpr int kOpenSteps = 5;          // places along an axis that no plane fixes, without a prior
constexpr int kMaxOpenSteps = 15;
constexpr double kOpenStep_m = 0.05;  // with one

/// Planes of the sweep as they are chosen, and the faces that they are put on.
struct Match {
  std::size_t count = 0;  // 2 or 3
  std::array<const SweepPlane*, 3> seen{};
  std::array<const Face*, 3> face{};
};

bool same_angle(const Match& match, std::size_t i, std::size_t j) {
  const double seen = match.seen[i]->normal_lidar.dot(match.seen[j]->normal_lidar);
  const double mapped = match.face[i]->normal_room.dot(match.face[j]->normal_room);
  return std::abs(seen - mapped) < kAngleCos;
}

double handedness(const Vec3& a, const Vec3& b, const Vec3& c) { return a.cross(b).dot(c); }

/// Rotation that turns the seen normals onto the mapped ones (least squares; Arun, Huang, Blostein 1987).
Mat33 rotation_of(const Match& match) {
  Mat33 M = Mat33::Zero();
  for (std::size_t i = 0; i < match.count; ++i) {
    M += match.face[i]->normal_room * match.seen[i]->normal_lidar.transpose();
  }
  if (match.count == 2) {
    const Vec3 mapped = match.face[0]->normal_room.cross(match.face[1]->normal_room);
    const Vec3 seen = match.seen[0]->normal_lidar.cross(match.seen[1]->normal_lidar);
    M += mapped * seen.transpose();
  }
  return nearest_rotation(M);
}

class Search {
 public:
  Search(const Surface& surface, std::span<const RayBlock> probe, const SweepPlanes& planes, const PosePrior* prior,
         Hypotheses& best)
      : surface_(surface), probe_(probe), planes_(planes), prior_(prior), best_(best) {
    if (prior == nullptr) return;
    const double sigma2 = prior->cov.bottomRightCorner<3, 3>().trace();
    greatest_turn_rad_ = std::sqrt(kPriorGate * std::max(sigma2, 1e-4));
    least_turn_cos_ = std::cos(std::min(kPi, greatest_turn_rad_ + kNormalSlack_rad));
  }

  void run() {
    const Corners corners = find_corners(planes_);
    for (const Corner& corner : corners) {
      if (corner.plane[2] >= kTopPlanes) continue;
      Match match{3, {&planes_[corner.plane[0]], &planes_[corner.plane[1]], &planes_[corner.plane[2]]}, {}};
      put_on_faces(match);
    }
    for (std::size_t j = 1; j < std::min(planes_.size(), kTopPlanes); ++j) {
      for (std::size_t i = 0; i < j; ++i) {
        if (std::abs(planes_[i].normal_lidar.dot(planes_[j].normal_lidar)) > 0.9) continue;
        Match match{2, {&planes_[i], &planes_[j], nullptr}, {}};
        put_on_faces(match);
      }
    }
    if (prior_ != nullptr) offer(prior_->T_room_lidar);
  }

 private:
  /// All ways to put the seen planes on faces at the same angles.
  void put_on_faces(Match& match) {
    for (const Face& first : surface_.faces()) {
      match.face[0] = &first;
      if (!turn_allowed(match, 0)) continue;
      for (const Face& second : surface_.faces()) {
        match.face[1] = &second;
        if (&second == &first || !same_angle(match, 0, 1) || !turn_allowed(match, 1)) continue;
        if (match.count == 2) {
          try_edge(match);
        } else {
          put_third(match);
        }
      }
    }
  }

  void put_third(Match& match) {
    for (const Face& third : surface_.faces()) {
      match.face[2] = &third;
      if (&third == match.face[0] || &third == match.face[1]) continue;
      if (!same_angle(match, 0, 2) || !same_angle(match, 1, 2)) continue;
      const double seen =
          handedness(match.seen[0]->normal_lidar, match.seen[1]->normal_lidar, match.seen[2]->normal_lidar);
      const double mapped =
          handedness(match.face[0]->normal_room, match.face[1]->normal_room, match.face[2]->normal_room);
      if (seen * mapped < 0) continue;
      try_corner(match);
    }
  }

  bool rotation_allowed(const Mat33& R) const {
    return prior_ == nullptr || rotation_angle_between(R, prior_->T_room_lidar.R) < greatest_turn_rad_;
  }

  /// Whether any allowed rotation turns the i-th seen normal onto the mapped one: asked before one is computed.
  bool turn_allowed(const Match& match, std::size_t i) const {
    if (prior_ == nullptr) return true;
    const Vec3 seen_room = prior_->T_room_lidar.R * match.seen[i]->normal_lidar;
    return match.face[i]->normal_room.dot(seen_room) > least_turn_cos_;
  }

  /// Plane equations n . t = d_seen - d_mapped of the matched planes.
  void try_corner(const Match& match) {
    const Mat33 R = rotation_of(match);
    if (!rotation_allowed(R)) return;
    Mat33 N;
    Vec3 rhs;
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(i);
      N.row(i) = match.face[k]->normal_room.transpose();
      rhs[i] = match.seen[k]->d_m - match.face[k]->d_m;
    }
    offer({R, N.inverse() * rhs});
  }

  void try_edge(const Match& match) {
    const Mat33 R = rotation_of(match);
    if (!rotation_allowed(R)) return;
    const Vec3& a = match.face[0]->normal_room;
    const Vec3& b = match.face[1]->normal_room;
    const Vec3 line = a.cross(b).normalized();
    Mat33 N;
    N << a.transpose(), b.transpose(), line.transpose();
    const Mat33 N_inverse = N.inverse();
    const double at_a = match.seen[0]->d_m - match.face[0]->d_m, at_b = match.seen[1]->d_m - match.face[1]->d_m;
    double low = extreme_along(line, false), high = extreme_along(line, true);
    int steps = kOpenSteps;
    if (prior_ != nullptr) {
      const Mat33 cov_room =
          prior_->T_room_lidar.R * prior_->cov.topLeftCorner<3, 3>() * prior_->T_room_lidar.R.transpose();
      const double reach_m = 2.5 * std::sqrt(line.dot(cov_room * line));
      low = std::max(low, line.dot(prior_->T_room_lidar.t) - reach_m);
      high = std::min(high, line.dot(prior_->T_room_lidar.t) + reach_m);
      steps = std::clamp(static_cast<int>((high - low) / kOpenStep_m), 1, kMaxOpenSteps);
    }
    for (int step = 0; step < steps; ++step) {
      offer({R, N_inverse * Vec3(at_a, at_b, low + (high - low) * (step + 0.5) / steps)});
    }
  }

  double extreme_along(const Vec3& line, bool high) const {
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      const double x = line[i] * surface_.low_room()[i], y = line[i] * surface_.high_room()[i];
      sum += high ? std::max(x, y) : std::min(x, y);
    }
    return sum;
  }

  void offer(const SE3& T_room_lidar) {
    constexpr double kOutside_m = 1;
    if (!T_room_lidar.t.allFinite()) return;  // parallel planes
    if (((surface_.low_room() - T_room_lidar.t).array() > kOutside_m).any()) return;
    if (((T_room_lidar.t - surface_.high_room()).array() > kOutside_m).any()) return;
    if (prior_ != nullptr && !within_prior(*prior_, T_room_lidar)) return;
    const double worst = best_.full() ? best_.back().score : kHopeless;
    const double score = score_pose(surface_, probe_, T_room_lidar, worst);
    if (score >= worst) return;
    std::size_t same = 0;
    while (same < best_.size() && !is_same(best_[same].T_room_lidar, T_room_lidar)) ++same;
    if (same < best_.size()) {
      if (score >= best_[same].score) return;
      best_[same] = {T_room_lidar, score};
    } else {
      if (best_.full()) best_.pop_back();
      if (!best_.push_back({T_room_lidar, score})) return;
    }
    std::sort(best_.begin(), best_.end(), [](const Hypothesis& a, const Hypothesis& b) { return a.score < b.score; });
  }

  static bool is_same(const SE3& a, const SE3& b) {
    return (a.t - b.t).norm() < kSame_m && rotation_angle_between(a.R, b.R) < kSame_rad;
  }

  const Surface& surface_;
  std::span<const RayBlock> probe_;
  const SweepPlanes& planes_;
  const PosePrior* prior_;
  Hypotheses& best_;
  double greatest_turn_rad_ = 0, least_turn_cos_ = -1;  ///< from the prior's rotation
};

}  // namespace

bool within_prior(const PosePrior& prior, const SE3& T_room_lidar) {
  const Vec6 off = se3_log(prior.T_room_lidar.inverse() * T_room_lidar);
  return off.dot(prior.cov.llt().solve(off)) < kPriorGate;
}

double score_pose(const Surface& surface, std::span<const RayBlock> rays, const SE3& T_room_lidar, double give_up) {
  const PosedSurface posed(surface, T_room_lidar);
  const auto count = static_cast<double>(std::max<std::size_t>(1, ray_count(rays)));
  BlockHits hits;
  double sum = 0;
  for (const RayBlock& block : rays) {
    posed.cast(block, hits);
    for (std::size_t i = 0; i < block.count; ++i) {
      const float height_m = posed.height_m()[static_cast<std::size_t>(hits.face[i])];
      const float off = (block.range_m[i] - 1 / hits.inverse_m[i]) / kUnit_m;
      const float met = std::min(off * off, off < 0 ? kInFront : kBehind);
      sum += static_cast<double>(height_m > 0 ? met : (height_m < 0 ? kBehind : kNothing));
    }
    if (sum >= give_up * count) break;
  }
  return sum / count;
}

void find_hypotheses(const Surface& surface, std::span<const RayBlock> probe, const SweepPlanes& planes,
                     const PosePrior* prior, Hypotheses& best) {
  best.clear();
  Search(surface, probe, planes, prior, best).run();
}

}  // namespace roomcal::scan
