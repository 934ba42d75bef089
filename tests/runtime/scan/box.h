#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "runtime/base/arena.h"
#include "runtime/scan/surface.h"

namespace roomcal::scan::test {

/// A box room from the origin to `size_m`, six faces: floor, ceiling, x0, x1, y0, y1.
class Box {
 public:
  explicit Box(const Vec3& size_m) : bytes_(Surface::bytes(6, 0)), arena_(bytes_) {
    const Vec3& s = size_m;
    const auto p = [&](int x, int y, int z) { return Vec3(x * s.x(), y * s.y(), z * s.z()); };
    const std::array<std::array<Vec3, 4>, 6> faces = {{{p(0, 0, 0), p(1, 0, 0), p(1, 1, 0), p(0, 1, 0)},
                                                       {p(0, 0, 1), p(0, 1, 1), p(1, 1, 1), p(1, 0, 1)},
                                                       {p(0, 0, 0), p(0, 1, 0), p(0, 1, 1), p(0, 0, 1)},
                                                       {p(1, 0, 0), p(1, 0, 1), p(1, 1, 1), p(1, 1, 0)},
                                                       {p(0, 0, 0), p(0, 0, 1), p(1, 0, 1), p(1, 0, 0)},
                                                       {p(0, 1, 0), p(1, 1, 0), p(1, 1, 1), p(0, 1, 1)}}};
    std::vector<Polygon> polygons;
    for (const auto& face : faces) polygons.push_back({face});
    surface_ = Surface::from_polygons(polygons, {}, arena_).value();
  }
  Box(const Box&) = delete;
  Box& operator=(const Box&) = delete;

  const Surface& surface() const { return surface_; }

 private:
  std::vector<std::byte> bytes_;
  Arena arena_;
  Surface surface_;
};

}  // namespace roomcal::scan::test
