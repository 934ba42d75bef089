#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/math/types.h"
#include "tools/common/random.h"

namespace roomcal::truth {

/// Seeded numbers for tests: the tools' generator, and what only tests draw.
class Random : public tools::Random {
 public:
  using tools::Random::Random;

  /// In [0, count).
  std::size_t index(std::size_t count) { return static_cast<std::size_t>(below(count)); }

  /// Independent standard normals.
  template <int N>
  Eigen::Matrix<double, N, 1> normals() {
    Eigen::Matrix<double, N, 1> v;
    for (int i = 0; i < N; ++i) v[i] = normal();
    return v;
  }
};

}  // namespace roomcal::truth
