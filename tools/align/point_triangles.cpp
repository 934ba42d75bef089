#include "tools/align/point_triangles.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace roomcal::tools {

namespace {

std::vector<std::size_t> nearest_of(std::span<const SpacePoint> points, std::size_t i, std::size_t count) {
  std::vector<std::pair<double, std::size_t>> others;
  for (std::size_t j = 0; j < points.size(); ++j) {
    if (j != i) others.emplace_back((points[j].p - points[i].p).squaredNorm(), j);
  }
  const std::size_t kept = std::min(count, others.size());
  std::partial_sort(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(kept), others.end());
  std::vector<std::size_t> near;
  for (std::size_t k = 0; k < kept; ++k) near.push_back(others[k].second);
  return near;
}

/// Corner i lies opposite edge i; corners sorted so that edges descend.
PointTriangle make_triangle(std::span<const SpacePoint> points, std::array<std::size_t, 3> corner) {
  const auto opposite_m = [&](std::size_t i) {
    return (points[corner[(i + 1) % 3]].p - points[corner[(i + 2) % 3]].p).norm();
  };
  std::array<std::pair<double, std::size_t>, 3> order;
  for (std::size_t i = 0; i < 3; ++i) order[i] = {-opposite_m(i), corner[i]};
  std::sort(order.begin(), order.end());
  PointTriangle triangle;
  for (std::size_t i = 0; i < 3; ++i) {
    triangle.corner[i] = order[i].second;
    triangle.edge_m[i] = -order[i].first;
  }
  return triangle;
}

void find_sigmas(std::span<const SpacePoint> points, PointTriangle& triangle) {
  for (std::size_t i = 0; i < 3; ++i) {
    const SpacePoint& from = points[triangle.corner[(i + 1) % 3]];
    const SpacePoint& to = points[triangle.corner[(i + 2) % 3]];
    const Vec3 along = (to.p - from.p) / triangle.edge_m[i];
    triangle.sigma_m[i] = std::sqrt(along.dot((from.cov_m2 + to.cov_m2) * along));
  }
}

}  // namespace

std::vector<PointTriangle> list_triangles(std::span<const SpacePoint> points, const TriangleMatchOptions& options) {
  std::set<std::array<std::size_t, 3>> triples;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::vector<std::size_t> near = nearest_of(points, i, options.neighbours);
    for (std::size_t a = 0; a < near.size(); ++a) {
      for (std::size_t b = a + 1; b < near.size(); ++b) {
        std::array<std::size_t, 3> triple{i, near[a], near[b]};
        std::sort(triple.begin(), triple.end());
        triples.insert(triple);
      }
    }
  }
  std::vector<PointTriangle> triangles;
  for (const auto& triple : triples) {
    PointTriangle triangle = make_triangle(points, triple);
    if (triangle.edge_m[0] > options.max_edge_m || triangle.edge_m[2] < options.min_edge_m) continue;
    find_sigmas(points, triangle);
    triangles.push_back(triangle);
  }
  return triangles;
}

}  // namespace roomcal::tools
