#pragma once

#include <cmath>
#include <cstdint>

#include "runtime/math/types.h"

namespace roomcal::truth {

/// Seeded numbers for tests, the same on every standard library: std distributions are not.
/// Source: Vigna, "splitmix64", public domain, 2015: 64 bits of state, passes BigCrush; plenty for truth data.
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}

  uint64_t bits() {
    uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31U);
  }

  /// In [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11U) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// In [0, count).
  std::size_t index(std::size_t count) { return static_cast<std::size_t>(bits() % count); }

  /// Standard normal (Box, Muller 1958; the second number is not kept, so that every call costs the same).
  double normal() {
    const double u = 1 - uniform();
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * kPi * uniform());
  }

  /// Independent standard normals.
  template <int N>
  Eigen::Matrix<double, N, 1> normals() {
    Eigen::Matrix<double, N, 1> v;
    for (int i = 0; i < N; ++i) v[i] = normal();
    return v;
  }

 private:
  uint64_t state_;
};

}  // namespace roomcal::truth
