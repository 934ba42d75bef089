#pragma once

#include <cmath>
#include <cstdint>

#include "runtime/math/types.h"

namespace roomcal::tools {

/// Seeded numbers that are the same on every machine, which the standard's distributions are not.
/// Source: SplitMix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014).
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}

  uint64_t bits() {
    uint64_t z = (state_ += 0x9E3779B97F4A7C15U);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31);
  }
  /// In [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// In [0, n); n > 0. The bias of the remainder is below n / 2^64.
  uint64_t below(uint64_t n) { return bits() % n; }
  /// Standard normal (Box-Muller; its twin is dropped, so every call takes two draws).
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * kPi * uniform());
  }

 private:
  uint64_t state_;
};

}  // namespace roomcal::tools
