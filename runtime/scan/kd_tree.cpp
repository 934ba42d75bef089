#include "runtime/scan/kd_tree.h"

namespace roomcal::scan {

namespace {

class OneNearest {
 public:
  OneNearest(float within_m, KdTree::Near& near) : near_(near) { near_ = {0, within_m * within_m}; }
  float reach_m2() const { return near_.squared_m2; }
  void offer(uint32_t index, float squared_m2) {
    near_ = {index, squared_m2};
    found = true;
  }
  bool found = false;

 private:
  KdTree::Near& near_;
};

class ManyNearest {
 public:
  explicit ManyNearest(std::span<KdTree::Near> near) : near_(near) {}
  float reach_m2() const {
    return count < near_.size() ? std::numeric_limits<float>::infinity() : near_[count - 1].squared_m2;
  }
  void offer(uint32_t index, float squared_m2) {
    std::size_t at = count < near_.size() ? count++ : count - 1;
    for (; at > 0 && near_[at - 1].squared_m2 > squared_m2; --at) near_[at] = near_[at - 1];
    near_[at] = {index, squared_m2};
  }
  std::size_t count = 0;

 private:
  std::span<KdTree::Near> near_;
};

}  // namespace

std::size_t KdTree::bytes(std::size_t points) { return points * (sizeof(Node) + 1) + 2 * alignof(std::max_align_t); }

Result<KdTree> KdTree::build(std::span<const Eigen::Vector3f> points, Arena& arena) {
  if (points.empty()) return Status{StatusCode::kTooFew, "scan: no points to search among"};
  if (points.size() >= std::numeric_limits<uint32_t>::max()) {
    return Status{StatusCode::kCapacity, "scan: too many points to search among"};
  }
  KdTree tree;
  tree.nodes_ = arena.allocate<Node>(points.size());
  tree.axis_ = arena.allocate<uint8_t>(points.size());
  if (tree.nodes_.empty() || tree.axis_.empty()) return out_of_arena("scan: arena too small, see KdTree::bytes()");
  for (std::size_t i = 0; i < points.size(); ++i) tree.nodes_[i] = {points[i], static_cast<uint32_t>(i)};

  std::array<Range, kMaxDepth + 2> open;
  std::size_t count = 0;
  open[count++] = {0, points.size(), 0};
  while (count > 0) {
    const Range range = open[--count];
    if (range.end - range.begin <= kLeaf) continue;
    Eigen::Vector3f low = tree.nodes_[range.begin].p, high = low;
    for (std::size_t i = range.begin; i < range.end; ++i) {
      low = low.cwiseMin(tree.nodes_[i].p);
      high = high.cwiseMax(tree.nodes_[i].p);
    }
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const std::size_t middle = range.begin + (range.end - range.begin) / 2;
    const auto at = [&](std::size_t i) { return tree.nodes_.begin() + static_cast<std::ptrdiff_t>(i); };
    // By index where coordinates are equal: grids have many, and every library must choose the same.
    std::nth_element(at(range.begin), at(middle), at(range.end), [axis](const Node& a, const Node& b) {
      return a.p[axis] != b.p[axis] ? a.p[axis] < b.p[axis] : a.index < b.index;
    });
    tree.axis_[middle] = static_cast<uint8_t>(axis);
    open[count++] = {middle + 1, range.end, 0};
    open[count++] = {range.begin, middle, 0};
  }
  return tree;
}

/// Depth first, the query's side first; a waiting range is dropped when it has come to lie out of reach.
template <typename Result>
void KdTree::search(const Eigen::Vector3f& query, Result& result) const {
  std::array<Range, kMaxDepth + 2> open;
  std::size_t count = 0;
  open[count++] = {0, nodes_.size(), 0};
  const auto offer = [&](const Node& node) {
    const float squared_m2 = (node.p - query).squaredNorm();
    if (squared_m2 < result.reach_m2()) result.offer(node.index, squared_m2);
  };
  while (count > 0) {
    const Range range = open[--count];
    if (range.squared_m2 >= result.reach_m2()) continue;
    if (range.end - range.begin <= kLeaf) {
      for (std::size_t i = range.begin; i < range.end; ++i) offer(nodes_[i]);
      continue;
    }
    const std::size_t middle = range.begin + (range.end - range.begin) / 2;
    offer(nodes_[middle]);
    const float off_m = query[axis_[middle]] - nodes_[middle].p[axis_[middle]];
    const Range below = {range.begin, middle, range.squared_m2}, above = {middle + 1, range.end, range.squared_m2};
    Range far = off_m < 0 ? above : below;
    far.squared_m2 = std::max(far.squared_m2, off_m * off_m);
    open[count++] = far;
    open[count++] = off_m < 0 ? below : above;
  }
}

bool KdTree::nearest(const Eigen::Vector3f& query, float within_m, Near& near) const {
  OneNearest result(within_m, near);
  search(query, result);
  return result.found;
}

std::size_t KdTree::nearest(const Eigen::Vector3f& query, std::span<Near> near) const {
  if (near.empty()) return 0;
  ManyNearest result(near);
  search(query, result);
  return result.count;
}

}  // namespace roomcal::scan
