#include "runtime/scan/planes.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace roomcal::scan {

namespace {

constexpr int kDraws = 80;                // six of ten local triples lie on one wall: one good is certain
constexpr std::size_t kProbe = 256;       // points that judge a triple
constexpr std::size_t kNeighbours = 150;  // in the sample's order: 25 degrees of azimuth for a spinning sensor
constexpr double kMinShare = 0.02;        // of the sample
constexpr std::size_t kMinPoints = 25;
constexpr double kMinSpread_m = 0.06;  // RMS along the narrow side; one ring on the floor is no plane
constexpr double kMaxOrthogonalCos = 0.26;

/// Marsaglia's xorshift: places in a table, nothing more is asked of it.
class Draw {
 public:
  std::size_t below(std::size_t n) {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 17;
    state_ ^= state_ << 5;
    return state_ % n;
  }

 private:
  uint32_t state_ = 2463534242U;
};

/// Points side by side.
template <std::size_t kCapacity>
struct Points {
  std::array<float, kCapacity> x, y, z;
  std::size_t count = 0;

  Vec3 at(std::size_t i) const {
    return Vec3(static_cast<double>(x[i]), static_cast<double>(y[i]), static_cast<double>(z[i]));
  }
  void add(float px, float py, float pz) {
    x[count] = px;
    y[count] = py;
    z[count] = pz;
    ++count;
  }
};

/// A plane in floats, to ask many points.
struct Sieve {
  Sieve(const SweepPlane& plane, double tolerance_m)
      : nx(static_cast<float>(plane.normal_lidar.x())),
        ny(static_cast<float>(plane.normal_lidar.y())),
        nz(static_cast<float>(plane.normal_lidar.z())),
        d(static_cast<float>(plane.d_m)),
        tolerance(static_cast<float>(tolerance_m)) {}
  template <typename Cloud>
  bool holds(const Cloud& points, std::size_t i) const {
    return std::abs(nx * points.x[i] + ny * points.y[i] + nz * points.z[i] + d) < tolerance;
  }
  float nx, ny, nz, d, tolerance;
};

class Extractor {
 public:
  Extractor(std::span<const RayBlock> sample, double sigma_m) : tolerance_m_(3 * sigma_m) {
    for (const RayBlock& block : sample) {
      for (std::size_t i = 0; i < block.count && free_.count < Samples::kMaxRays; ++i) {
        const float range_m = block.range_m[i];
        free_.add(range_m * block.x[i], range_m * block.y[i], range_m * block.z[i]);
      }
    }
    min_points_ = std::max(kMinPoints, static_cast<std::size_t>(kMinShare * static_cast<double>(free_.count)));
  }

  /// The best plane among the free points; false if none is left.
  bool next(SweepPlane& plane) {
    if (free_.count < min_points_ || !best_triple(plane)) return false;
    for (int round = 0; round < 3; ++round) {
      if (!refit(plane)) return false;
    }
    take_away(plane);
    return true;
  }

 private:
  bool best_triple(SweepPlane& best) {
    std::size_t most = 2;
    const std::size_t step = (free_.count + kProbe - 1) / kProbe;
    probe_.count = 0;
    for (std::size_t i = 0; i < free_.count; i += step) probe_.add(free_.x[i], free_.y[i], free_.z[i]);
    for (int draw = 0; draw < kDraws; ++draw) {
      SweepPlane plane;
      if (!through_triple(plane)) continue;
      const Sieve sieve(plane, tolerance_m_);
      uint32_t count = 0;
      for (std::size_t i = 0; i < probe_.count; ++i) count += sieve.holds(probe_, i) ? 1U : 0U;
      if (count <= most) continue;
      most = count;
      best = plane;
    }
    return most > 2;
  }

  bool through_triple(SweepPlane& plane) {
    const std::size_t i = draw_.below(free_.count);
    const auto near = [&] { return (i + 1 + draw_.below(2 * kNeighbours) + free_.count - kNeighbours) % free_.count; };
    if (free_.count <= kNeighbours) return through(i, draw_.below(free_.count), draw_.below(free_.count), plane);
    return through(i, near(), near(), plane);
  }

  bool through(std::size_t i, std::size_t j, std::size_t k, SweepPlane& plane) const {
    const Vec3 a = free_.at(i), b = free_.at(j), c = free_.at(k);
    const Vec3 cross = (b - a).cross(c - a);
    const double longest_m = std::max({(b - a).norm(), (c - a).norm(), (c - b).norm()});
    if (!(cross.norm() > 4 * tolerance_m_ * longest_m)) return false;  // a sliver: its normal is noise
    plane.normal_lidar = cross.normalized();
    plane.d_m = -plane.normal_lidar.dot(a);
    return true;
  }

  bool refit(SweepPlane& plane) const {
    const Sieve sieve(plane, tolerance_m_);
    Vec3 sum = Vec3::Zero();
    Mat33 squares = Mat33::Zero();
    std::size_t count = 0;
    for (std::size_t i = 0; i < free_.count; ++i) {
      if (!sieve.holds(free_, i)) continue;
      const Vec3 p = free_.at(i);
      sum += p;
      squares += p * p.transpose();
      ++count;
    }
    if (count < min_points_) return false;
    const double n = static_cast<double>(count);
    const Vec3 mean = sum / n;
    Eigen::SelfAdjointEigenSolver<Mat33> spread;
    spread.computeDirect(squares / n - mean * mean.transpose());
    if (!(spread.eigenvalues()[1] > kMinSpread_m * kMinSpread_m)) return false;
    plane.normal_lidar = spread.eigenvectors().col(0).normalized();
    if (plane.normal_lidar.dot(mean) > 0) plane.normal_lidar = -plane.normal_lidar;  // the sensor is in free space
    plane.d_m = -plane.normal_lidar.dot(mean);
    plane.rms_m = std::sqrt(std::max(0.0, spread.eigenvalues()[0]));
    plane.points = static_cast<uint32_t>(count);
    return true;
  }

  void take_away(const SweepPlane& plane) {
    const Sieve sieve(plane, tolerance_m_);
    const std::size_t count = free_.count;
    free_.count = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (!sieve.holds(free_, i)) free_.add(free_.x[i], free_.y[i], free_.z[i]);
    }
  }

  double tolerance_m_;
  std::size_t min_points_ = kMinPoints;
  Points<Samples::kMaxRays> free_;
  Points<kProbe> probe_;
  Draw draw_;
};

bool orthogonal(const SweepPlane& a, const SweepPlane& b) {
  return std::abs(a.normal_lidar.dot(b.normal_lidar)) < kMaxOrthogonalCos;
}

Corner corner_of(const SweepPlanes& planes, std::size_t i, std::size_t j, std::size_t k) {
  Mat33 normals;
  normals << planes[i].normal_lidar, planes[j].normal_lidar, planes[k].normal_lidar;
  Corner corner;
  corner.p_lidar = -normals.transpose().inverse() * Vec3(planes[i].d_m, planes[j].d_m, planes[k].d_m);
  const Eigen::JacobiSVD<Mat33> svd(normals, Eigen::ComputeFullU | Eigen::ComputeFullV);
  corner.directions_lidar = svd.matrixU() * svd.matrixV().transpose();  // keeps the handedness of the normals
  corner.plane = {static_cast<uint8_t>(i), static_cast<uint8_t>(j), static_cast<uint8_t>(k)};
  return corner;
}

}  // namespace

SweepPlanes extract_planes(std::span<const RayBlock> sample, double sigma_m) {
  SweepPlanes planes;
  Extractor extractor(sample, sigma_m);
  SweepPlane plane;
  int failures = 0;
  while (!planes.full() && failures < 3) {
    if (!extractor.next(plane)) {
      ++failures;
    } else if (!planes.push_back(plane)) {
      break;
    }
  }
  std::sort(planes.begin(), planes.end(), [](const SweepPlane& a, const SweepPlane& b) { return a.points > b.points; });
  return planes;
}

Corners find_corners(const SweepPlanes& planes) {
  Corners corners;
  for (std::size_t k = 2; k < planes.size(); ++k) {
    for (std::size_t j = 1; j < k; ++j) {
      for (std::size_t i = 0; i < j; ++i) {
        if (!orthogonal(planes[i], planes[j]) || !orthogonal(planes[i], planes[k])) continue;
        if (!orthogonal(planes[j], planes[k])) continue;
        if (!corners.push_back(corner_of(planes, i, j, k))) return corners;
      }
    }
  }
  return corners;
}

}  // namespace roomcal::scan
