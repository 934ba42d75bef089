#include "runtime/math/dense_ldlt.h"

#include <cassert>

namespace roomcal {

namespace {

constexpr double kMinRelativePivot = 1e-13;

}  // namespace

Status ldlt_factor(std::span<double> A, std::size_t n) {
  assert(A.size() >= n * n);
  for (std::size_t j = 0; j < n; ++j) {
    double* row_j = &A[j * n];
    // Row j of L, still multiplied by D, then the pivot.
    for (std::size_t k = 0; k < j; ++k) {
      const double* row_k = &A[k * n];
      for (std::size_t m = 0; m < k; ++m) row_j[k] -= row_j[m] * row_k[m];
    }
    const double diagonal = row_j[j];
    double pivot = diagonal;
    for (std::size_t k = 0; k < j; ++k) {
      const double scaled = row_j[k];
      row_j[k] = scaled / A[k * n + k];
      pivot -= scaled * row_j[k];
    }
    if (!(pivot > kMinRelativePivot * diagonal)) return {StatusCode::kDegenerate, "matrix is not positive definite"};
    row_j[j] = pivot;
  }
  return ok_status();
}

void ldlt_solve(std::span<const double> L, std::size_t n, std::span<double> b) {
  assert(L.size() >= n * n && b.size() >= n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < i; ++k) b[i] -= L[i * n + k] * b[k];
  for (std::size_t i = 0; i < n; ++i) b[i] /= L[i * n + i];
  for (std::size_t i = n; i-- > 0;)
    for (std::size_t k = i + 1; k < n; ++k) b[i] -= L[k * n + i] * b[k];
}

void ldlt_inverse(std::span<const double> L, std::size_t n, std::span<double> A_inverse) {
  assert(A_inverse.size() >= n * n);
  for (std::size_t row = 0; row < n; ++row) {
    const std::span<double> column = A_inverse.subspan(row * n, n);  // the inverse is symmetric
    for (std::size_t i = 0; i < n; ++i) column[i] = i == row ? 1 : 0;
    ldlt_solve(L, n, column);
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j)
      A_inverse[i * n + j] = A_inverse[j * n + i] = 0.5 * (A_inverse[i * n + j] + A_inverse[j * n + i]);
}

}  // namespace roomcal
