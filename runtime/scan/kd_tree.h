#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/math/types.h"

namespace roomcal::scan {

/// Points in space by nearness, in an arena. Balanced: the middle of a range of points splits it, no node is stored.
///
/// Like nanoflann's index in use, but it takes its memory from an arena, does not recurse, and so may be built after
/// arming, of a sweep.
class KdTree {
 public:
  struct Near {
    uint32_t index = 0;  ///< among the points as they were given
    float squared_m2 = std::numeric_limits<float>::infinity();
  };

  KdTree() = default;

  /// Copies the points. @param points  finite.
  /// @return kTooFew (no point), kCapacity (2^32 and more), kOutOfMemory. Cost: n log^2 n; 3 ms for 28,000 points.
  static Result<KdTree> build(std::span<const Eigen::Vector3f> points, Arena& arena);
  static std::size_t bytes(std::size_t points);

  std::size_t size() const { return nodes_.size(); }

  /// The nearest point within a distance. @return false if there is none.
  /// Cost: about 0.3 us among 20,000 points.
  bool nearest(const Eigen::Vector3f& query, float within_m, Near& near) const;

  /// The nearest `near.size()` points, nearest first. @return how many there are.
  std::size_t nearest(const Eigen::Vector3f& query, std::span<Near> near) const;

 private:
  static constexpr std::size_t kLeaf = 8;
  static constexpr std::size_t kMaxDepth = 32;

  struct Node {
    Eigen::Vector3f p = Eigen::Vector3f::Zero();
    uint32_t index = 0;
  };
  struct Range {
    std::size_t begin = 0, end = 0;
    float squared_m2 = 0;  ///< of the query to it, at least
  };

  template <typename Result>
  void search(const Eigen::Vector3f& query, Result& result) const;

  std::span<Node> nodes_;
  std::span<uint8_t> axis_;  ///< that the node in the middle of its range splits
};

}  // namespace roomcal::scan
