#pragma once

#include <Eigen/Core>

namespace roomcal {

/// Central differences of a vector function, for tests: J(i, j) = d f_i / d x_j.
/// @param f     callable Eigen vector -> Eigen vector (fixed sizes).
/// @param step  about the cube root of the wanted relative error; 1e-6 leaves 1e-9 for functions of order one.
template <int M, int N, typename F>
Eigen::Matrix<double, M, N> numeric_jacobian(const F& f, const Eigen::Matrix<double, N, 1>& x, double step = 1e-6) {
  Eigen::Matrix<double, M, N> J;
  for (int j = 0; j < N; ++j) {
    Eigen::Matrix<double, N, 1> plus = x, minus = x;
    plus[j] += step;
    minus[j] -= step;
    J.col(j) = (f(plus) - f(minus)) / (2 * step);
  }
  return J;
}

}  // namespace roomcal
