#pragma once

#include <cstddef>
#include <span>

#include "runtime/base/status.h"

namespace roomcal {

/// Symmetric positive definite systems whose size is known at run time only, over memory of the caller: row-major
/// n x n, the lower triangle counts. Eigen's dynamic matrices would allocate.

/// A = L D L^T in place: D on the diagonal, L (unit diagonal) below; the upper triangle is left alone.
/// Source: Golub, Van Loan, "Matrix Computations", 4th ed., algorithm 4.1.2; no pivoting, A is positive definite.
/// @return kDegenerate if a pivot falls below 1e-13 of its diagonal element: not positive definite to working
///         precision; A is then spoilt. Cost: n^3 / 6 multiplications.
Status ldlt_factor(std::span<double> A, std::size_t n);

/// b := A^-1 b with the factors from ldlt_factor(). Cost: n^2 multiplications.
void ldlt_solve(std::span<const double> L, std::size_t n, std::span<double> b);

/// The whole, exactly symmetric inverse. @param[out] A_inverse n x n, not the factors' memory. Cost: n^3.
void ldlt_inverse(std::span<const double> L, std::size_t n, std::span<double> A_inverse);

}  // namespace roomcal
