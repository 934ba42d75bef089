#include "runtime/pose/delaunay.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace roomcal::pose {
namespace {

constexpr int kNone = -1;
/// Size of the outermost triangle over the points' extent: large enough that only slivers at the hull are lost, small
/// enough that the circle test keeps nine digits.
constexpr double kOuterSize = 1e3;
/// A circle counts as entered beyond this part of the test's own magnitude: keeps four points on a circle from
/// flipping for ever.
constexpr double kCircleTolerance = 1e-12;

struct Face {
  std::array<int, 3> vertex{};                        // counter-clockwise
  std::array<int, 3> across = {kNone, kNone, kNone};  // face beyond the edge opposite to vertex[i]
};

double twice_area(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

bool inside_circle(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& p) {
  const Vec2 d = a - p;
  const Vec2 e = b - p;
  const Vec2 f = c - p;
  const double t1 = d.squaredNorm() * (e.x() * f.y() - e.y() * f.x());
  const double t2 = e.squaredNorm() * (f.x() * d.y() - f.y() * d.x());
  const double t3 = f.squaredNorm() * (d.x() * e.y() - d.y() * e.x());
  return t1 + t2 + t3 > kCircleTolerance * (std::abs(t1) + std::abs(t2) + std::abs(t3));
}

class Triangulator {
 public:
  Triangulator(std::span<Vec2> vertex, std::span<Face> face, std::span<int> stack)
      : vertex_(vertex), face_(face), stack_(stack) {}

  void insert_all(std::size_t points) {
    const int n = static_cast<int>(points);
    face_[0].vertex = {n, n + 1, n + 2};
    face_count_ = 1;
    for (int i = 0; i < n; ++i) insert(i);
  }
  std::span<const Face> faces() const { return face_.first(static_cast<std::size_t>(face_count_)); }

 private:
  Face& at(int f) { return face_[static_cast<std::size_t>(f)]; }
  const Vec2& point(int v) const { return vertex_[static_cast<std::size_t>(v)]; }

  /// The face that holds p, by walking towards it; a full pass should rounding ever trap the walk.
  int locate(const Vec2& p) {
    int f = face_count_ - 1;
    for (int step = 0; step < face_count_ + 8; ++step) {
      int next = kNone;
      for (std::size_t i = 0; i < 3 && next == kNone; ++i) {
        const std::size_t j = (i + 1 + static_cast<std::size_t>(step) % 2) % 3;  // alternate: no cycles
        if (twice_area(point(at(f).vertex[(j + 1) % 3]), point(at(f).vertex[(j + 2) % 3]), p) < 0)
          next = at(f).across[j];
      }
      if (next == kNone) return f;
      f = next;
    }
    return locate_by_search(p);
  }

  int locate_by_search(const Vec2& p) {
    int best = 0;
    double best_margin = -INFINITY;
    for (int f = 0; f < face_count_; ++f) {
      double margin = INFINITY;
      for (std::size_t i = 0; i < 3; ++i) {
        margin = std::min(margin, twice_area(point(at(f).vertex[(i + 1) % 3]), point(at(f).vertex[(i + 2) % 3]), p));
      }
      if (margin > best_margin) {
        best_margin = margin;
        best = f;
      }
    }
    return best;
  }

  void relink(int face, int from, int to) {
    if (face == kNone) return;
    for (int& across : at(face).across) {
      if (across == from) across = to;
    }
  }

  void insert(int v) {
    const int f0 = locate(point(v));
    const Face old = at(f0);
    for (const int corner : old.vertex) {
      if ((point(corner) - point(v)).squaredNorm() < 1e-24) return;  // seen before
    }
    const int f1 = face_count_++;
    const int f2 = face_count_++;
    at(f0) = {{v, old.vertex[1], old.vertex[2]}, {old.across[0], f1, f2}};
    at(f1) = {{v, old.vertex[2], old.vertex[0]}, {old.across[1], f2, f0}};
    at(f2) = {{v, old.vertex[0], old.vertex[1]}, {old.across[2], f0, f1}};
    relink(old.across[1], f0, f1);
    relink(old.across[2], f0, f2);
    stack_size_ = 0;
    push(f0);
    push(f1);
    push(f2);
    legalize(v);
  }

  void push(int f) {
    if (stack_size_ < stack_.size()) stack_[stack_size_++] = f;
  }

  /// Every face on the stack has the new vertex at [0]; the edge opposite to it may have to be flipped.
  void legalize(int v) {
    while (stack_size_ > 0) {
      const int f = stack_[--stack_size_];
      const int g = at(f).across[0];
      if (g == kNone) continue;
      std::size_t k = 0;
      while (k < 3 && at(g).across[k] != f) ++k;
      if (k == 3) continue;
      const int far = at(g).vertex[k];
      const Face& t = at(f);
      if (!inside_circle(point(t.vertex[0]), point(t.vertex[1]), point(t.vertex[2]), point(far))) continue;
      flip(f, g, k, v, far);
    }
  }

  /// Faces (v, a, b) and (far, b, a) become (v, a, far) and (v, far, b).
  void flip(int f, int g, std::size_t k, int v, int far) {
    const int a = at(f).vertex[1];
    const int b = at(f).vertex[2];
    if (twice_area(point(v), point(a), point(far)) <= 0 || twice_area(point(v), point(far), point(b)) <= 0) return;
    const int beyond_va = at(f).across[2];
    const int beyond_bv = at(f).across[1];
    // In g = (far, b, a) the edge opposite to b is (a, far), the one opposite to a is (far, b).
    const int beyond_a_far = at(g).across[(k + 1) % 3];
    const int beyond_far_b = at(g).across[(k + 2) % 3];
    at(f) = {{v, a, far}, {beyond_a_far, g, beyond_va}};
    at(g) = {{v, far, b}, {beyond_far_b, beyond_bv, f}};
    relink(beyond_a_far, g, f);
    relink(beyond_bv, f, g);
    push(f);
    push(g);
  }

  std::span<Vec2> vertex_;
  std::span<Face> face_;
  std::span<int> stack_;
  std::size_t stack_size_ = 0;
  int face_count_ = 0;
};

/// Points scaled into the unit square about their middle, and the outermost triangle behind them.
void fill_vertices(std::span<const Vec2> point, std::span<Vec2> vertex) {
  Vec2 low = point[0];
  Vec2 high = point[0];
  for (const Vec2& p : point) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vec2 middle = 0.5 * (low + high);
  const double extent = std::max((high - low).maxCoeff(), 1e-300);
  for (std::size_t i = 0; i < point.size(); ++i) vertex[i] = (point[i] - middle) / extent;
  const std::size_t n = point.size();
  vertex[n] = Vec2(-1.7, -1.0) * kOuterSize;
  vertex[n + 1] = Vec2(1.7, -1.0) * kOuterSize;
  vertex[n + 2] = Vec2(0.0, 2.0) * kOuterSize;
}

std::size_t face_capacity(std::size_t points) { return 2 * points + 1; }
std::size_t stack_capacity(std::size_t points) { return 2 * points + 16; }

}  // namespace

std::size_t delaunay_bytes(std::size_t points) {
  return face_capacity(points) * (sizeof(Triple) + sizeof(Face)) + (points + 3) * sizeof(Vec2) +
         stack_capacity(points) * sizeof(int) + 4 * alignof(std::max_align_t);
}

Status delaunay(std::span<const Vec2> point, Arena& arena, std::span<Triple>& triples) {
  triples = {};
  if (point.size() < 3) return ok_status();
  if (point.size() > 65532) return {StatusCode::kCapacity, "more points than a triple can number"};
  std::span<Triple> out = arena.allocate<Triple>(face_capacity(point.size()));
  if (out.empty()) return out_of_arena("Delaunay triples");
  Arena::Scope scope(arena);
  std::span<Vec2> vertex = arena.allocate<Vec2>(point.size() + 3);
  std::span<Face> face = arena.allocate<Face>(face_capacity(point.size()));
  std::span<int> stack = arena.allocate<int>(stack_capacity(point.size()));
  if (vertex.empty() || face.empty() || stack.empty()) return out_of_arena("Delaunay faces");
  fill_vertices(point, vertex);
  Triangulator triangulator(vertex, face, stack);
  triangulator.insert_all(point.size());
  std::size_t count = 0;
  const int n = static_cast<int>(point.size());
  for (const Face& f : triangulator.faces()) {
    if (f.vertex[0] >= n || f.vertex[1] >= n || f.vertex[2] >= n) continue;
    out[count++] = {static_cast<uint16_t>(f.vertex[0]), static_cast<uint16_t>(f.vertex[1]),
                    static_cast<uint16_t>(f.vertex[2])};
  }
  triples = out.first(count);
  return ok_status();
}

}  // namespace roomcal::pose
